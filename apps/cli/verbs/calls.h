// What verbs do once their files are read, for callers that have no command line (apps/python):
// options as plain structs, inputs as recordings and scenes, the verb's own JSON keys as the
// answer. The verbs call the same functions, so that the numbers are the same.
//
// Findings go to `context`: warnings, refusals and the exit code that the program would end with.
// Every function throws UsageError for options that contradict each other, Refused and NotConverged
// where there is no result at all, and what the library functions behind it throw.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/campaign_file/bending_files.h"
#include "apps/campaign_file/update_data.h"
#include "apps/cli/verb.h"
#include "apps/cli/verbs/impact_command.h"
#include "ident/campaign/single_tests/axial_campaign.h"
#include "ident/campaign/single_tests/bending_campaign.h"
#include "ident/update/model_update.h"
#include "ident/virtual_rig/virtual_rig.h"
#include "model/response/response.h"
#include "model/scene/scene.h"
#include "signal/modal/modal_identification.h"
#include "signal/recording/recording.h"
#include "signal/recording/resample.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::apps {

struct InspectCommand {
  std::vector<std::string> files;
  double sample_rate_hz = 0;
};
/// One entry of `recordings[]`.
[[nodiscard]] Json inspect_result(const signal::Recording& recording, VerbContext& context);
/// The same of a file, which may hold functions that are not over time; a rate of 0: as the file
/// says.
[[nodiscard]] Json inspect_file(const std::string& path, double sample_rate_hz,
                                VerbContext& context);

struct ResampleCommand {
  std::string file, out;  ///< no file is written without `out`
  double rate_hz = 0;     ///< 0: of uneven times that of their usual step
  double sample_rate_hz = 0;
};
/// The recording at its new rate goes to `result`.
[[nodiscard]] Json resample_result(const signal::Recording& recording,
                                   const ResampleCommand& command, VerbContext& context,
                                   signal::ResampleResult& result);

struct DecayCommand {
  std::string file, channel;  ///< name or "#number"; may be empty where there is one
  std::optional<double> start_s, end_s;
  std::vector<double> band;  ///< Hz, two or none
  double sample_rate_hz = 0;
  bool each = false;
  int max_modes = signal::DecayOptions{}.max_modes;
};
[[nodiscard]] Json decay_result(const signal::Recording& recording, const DecayCommand& command,
                                VerbContext& context);

struct FrfCommand {
  ImpactCommand impact;
  std::string out, csv;
  std::string encoding = "binary";
};
[[nodiscard]] Json frf_result(const ImpactRun& run, const FrfCommand& command,
                              VerbContext& context);

struct ModalCommand {
  std::vector<std::string> files;
  ImpactCommand impact;
  int order = signal::LscfOptions().max_order;
  double max_damping = signal::LscfOptions().max_damping_ratio;
  int averages = 0;  ///< behind the coherence of FRFs from a file; 0: as the file says
  std::string out, synthesis;
  bool all = false;                     ///< print uncertain modes as well
  bool ambient = false;                 ///< motion under unknown forces: no FRFs, no hits
  std::vector<std::string> references;  ///< of ambient motion, in all set-ups
  std::vector<std::string> of_hits;     ///< options given that mean nothing for FRFs from a file
};
/// FRFs to identify, and where they are from.
struct MeasuredFrfs {
  signal::FrfSet frfs;
  double usable_hz = 0;                  ///< 0: to the last line
  bool amplitudes = true;                ///< false: only frequencies and damping mean something
  Json hits, force_window;               ///< null when the FRFs came from a file
  std::shared_ptr<const ImpactRun> run;  ///< for figures; null: none wanted, FRFs from a file
};
/// FRFs from hits just analysed.
[[nodiscard]] MeasuredFrfs measured_frfs(const ImpactRun& run);
/// FRFs read from `command.files`: one UFF file, or text tables.
[[nodiscard]] MeasuredFrfs measured_frfs(const ModalCommand& command, VerbContext& context);
/// FRFs of another analyser: takes off its window, and makes error bars from the coherence where
/// the file has none.
[[nodiscard]] MeasuredFrfs measured_frfs(signal::FrfSet frfs, const ModalCommand& command,
                                         VerbContext& context);
[[nodiscard]] Json modal_result(const MeasuredFrfs& measured, const ModalCommand& command,
                                VerbContext& context);
/// The same of ambient motion, read from `command.files`: a set-up each, joined by references.
[[nodiscard]] Json ambient_result(const ModalCommand& command, VerbContext& context);

struct BendingCommand {
  std::vector<std::string> files;
  BendingColumns columns;
  ident::BendingCampaign campaign;  ///< its sources, read
  double span = 0, span_std = 0;
  std::vector<double> strand;  ///< E, elements, element diameter, strand diameter
  std::optional<double> EA, mass_per_length;
  /// "clamped", "pinned", "cantilever" without tension (columns.tension "0"); empty: clamped.
  std::string ends;
  // Cross-section of a beam without tension: one of them, or none; m, m4.
  std::vector<double> rectangle;  ///< width, height
  double diameter = 0, second_moment = 0;
  double section_std = 0;  ///< relative standard uncertainty of the second moment
};
/// Adds a recording's points or record to the campaign.
void add_bending_source(const signal::Recording& recording, BendingCommand& command,
                        VerbContext& context);
[[nodiscard]] Json bending_result(BendingCommand command, VerbContext& context);

struct AxialCommand {
  std::vector<std::string> files;     ///< names of the recordings
  std::vector<double> lengths, band;  ///< m: one, one a file, or one a group of files; Hz
  std::string channel;
  double mass = 0, mass_std = 0, mass_per_length = 0, mass_per_length_std = 0;
  double length_std = -1;  ///< negative: not given
  double adapter = 0, adapter_std = 0, catalogue = 0, sample_rate_hz = 0;
  double compliance_std = -1;  ///< negative: not given
  std::string frame;           ///< stiffness, N/m, or "rigid"; empty: not given
  double frame_std = 0;
  std::vector<double> adapter_bar;  ///< E Pa, A m2, l m
};
/// `recordings`: one for each of `command.files`, in that order.
[[nodiscard]] Json axial_result(const AxialCommand& command,
                                std::vector<signal::Recording> recordings, VerbContext& context);

struct ModesCommand {
  std::string scene;  ///< name in messages
  int count = 6;
  std::vector<double> band;
  int segments = 0;
  std::string rotary_inertia = "accurate";
  std::string torsion = "auto";
  bool shapes = false;
};
[[nodiscard]] Json modes_result(const model::Scene& scene, const ModesCommand& command,
                                VerbContext& context);

struct RespondCommand {
  std::string scene, out;
  double duration_s = 0, rate_hz = 0;
  std::string solver = "auto";
  std::string plane = "auto", axial = "auto";
  int segments = 0;
  double step_s = 0;
  double tolerance = 0;
};
/// The response with its samples goes to `response`.
[[nodiscard]] Json respond_result(const model::Scene& scene, const RespondCommand& command,
                                  VerbContext& context, model::ResponseResult& response);

struct UpdateCommand {
  UpdateData data;
  std::vector<double> band;
  std::vector<std::string> free, priors, inputs, aims;
  std::string candidates;         ///< file (apps/cli/verbs/update_candidates.h); empty: none
  std::vector<std::string> ends;  ///< "pinned", "clamped", "springs", "own springs": the same
  std::string out, axial;
  bool axial_damping = false;
  bool hold_out = false, profile = false;
  int monte_carlo = 0, starts = 4;
  double start_spread = 3, assumed_std = 0.01, model_std = 0, frf_model_std = 0, shape_std = 0;
  double stiffness_common_std = 0;
};
/// The fit with its scenes goes to `result`; with candidates it is that of the heaviest, whose
/// scenes `states` then holds.
[[nodiscard]] Json update_result(UpdateStates& states, const UpdateCommand& command,
                                 VerbContext& context, ident::UpdateResult& result);

/// The fitted scene of each state, with the segments that its file asks for.
[[nodiscard]] std::vector<model::Scene> updated_scenes(const UpdateStates& states,
                                                       const ident::UpdateResult& result);

struct TensionCommand {
  std::vector<std::string> files, channels;
  std::vector<double> frequencies, band;
  std::string measured, column, plane = "any", length, mass, EI, EA, mass_of, ends = "compare";
  double frequency_std = 0, inclination = 0, sample_rate_hz = 0, missed = 0.1, false_mode = 0.05;
  int max_peaks = 12;
  std::vector<double> orders;       ///< whole numbers, one for each of `frequencies`
  std::vector<std::string> masses;  ///< "PLACE=KG[,STD]"
  std::string table, out;           ///< many cables, a row each (campaign_file/cable_table.h)
};
/// `recordings`: one for each of `command.files`, in that order.
[[nodiscard]] Json tension_result(const TensionCommand& command,
                                  const std::vector<signal::Recording>& recordings,
                                  VerbContext& context);

/// `cables[]`, one a row: its result, or `error` and a refusal `bad_row` or of the analysis.
[[nodiscard]] Json tension_table_result(const TensionCommand& command, VerbContext& context);

struct PredictCommand {
  std::string scene;  ///< name in messages
  std::string from, measured, column, plane = "any", frf, response;
  double duration_s = 2, rate_hz = 500;  ///< predicted response
  std::vector<std::string> maps, damage, inputs;
  std::vector<double> band;
  int count = 6, segments = 0, lines = 400;
  bool sample = false, accept_fit = false;
};
[[nodiscard]] Json predict_result(const model::Scene& scene, const PredictCommand& command,
                                  VerbContext& context);

struct SynthesizeOptions {
  std::string scene;  ///< name in messages
  std::string out;
  std::vector<double> tensions;
  double tension_std = 0;
  std::string stiffness;
  std::string format = "csv";
  ident::VirtualRigOptions rig;
  double bending_span = 0;
  double bending_peak_load = 10;
  std::vector<double> axial_lengths;
  double axial_length_std = 0;
  double axial_mass = 2.2;
  double axial_damping_ratio = 0.017;
  int taps = 5;
};
[[nodiscard]] Json synthesize_result(const model::Scene& scene, const SynthesizeOptions& options,
                                     VerbContext& context);

struct ReportCommand {
  std::vector<std::string> campaigns;  ///< one, or two to be compared
  std::string out, style = "lab";
  bool pdf = false, force = false;
  std::vector<double> figure_size;  ///< mm
  std::string figure_font = "sans-serif";
  double figure_font_size = 8;  ///< pt
};
[[nodiscard]] Json report_result(const ReportCommand& command, VerbContext& context);

// The options of each, described.
[[nodiscard]] describe::Options options_of(InspectCommand& command);
[[nodiscard]] describe::Options options_of(ResampleCommand& command);
[[nodiscard]] describe::Options options_of(DecayCommand& command);
[[nodiscard]] describe::Options options_of(FrfCommand& command);
[[nodiscard]] describe::Options options_of(ModalCommand& command);
[[nodiscard]] describe::Options options_of(BendingCommand& command);
[[nodiscard]] describe::Options options_of(AxialCommand& command);
[[nodiscard]] describe::Options options_of(ModesCommand& command);
[[nodiscard]] describe::Options options_of(RespondCommand& command);
[[nodiscard]] describe::Options options_of(UpdateCommand& command);
[[nodiscard]] describe::Options options_of(TensionCommand& command);
[[nodiscard]] describe::Options options_of(PredictCommand& command);
[[nodiscard]] describe::Options options_of(SynthesizeOptions& command);
[[nodiscard]] describe::Options options_of(ReportCommand& command);

}  // namespace rigfit::apps
