// A campaign: what was tested on a rig, how, which scenes stand for it, what to fit and which
// published or earlier results to compare with. One TOML file; paths in it are relative to it.
//
//   title = "..."        source = "..."        description = "..."
//   [report]             author, organisation, client, project, date, revision, logo:
//   report_details.h [strand]             youngs_modulus (Pa), wires, wire_diameter, diameter (m):
//   bounds on EI
//   [[scene]]            name, file; tables published / inferred / assumed: parameter = how known
//   [[test]]             name, kind, title, and by kind:
//     kind = "bending"   span (m), and a [test.table] with columns tension, EI, or recordings:
//                        span_std (m), tension_zero_std (N), tension_calibration_std,
//                        load_calibration_std, deflection_calibration_std (relative),
//                        channels = { tension, load, deflection } (default: as
//                        `rigfit bending` finds them); a table may hold several tensions;
//                        tension = 0: a beam without tension, by dead weights or a testing
//                        machine, with ends ("clamped", "pinned", "cantilever"), and for its
//                        modulus rectangle = [width, height], diameter (m) or second_moment (m4)
//                        with section_std (relative)
//     kind = "axial"     mass (kg, hung), mass_std, mass_per_length (kg/m), mass_per_length_std,
//                        length_std (m), adapter_stiffness (N/m), adapter_stiffness_std,
//                        frame_stiffness (N/m, or "rigid"), frame_stiffness_std,
//                        compliance_std (m/N, of what else gives way in series; 0: rigid),
//                        catalogue_EA (N), channel, band = [LO, HI] (Hz); recordings with length
//     kind = "decay"     free decays: channels (default: all), band; with scene, tension_of, EI_of,
//                        EA_of, damping_of (parameters that take the axial test's damping ratio),
//                        load: the scene's release or impact is simulated and laid over them
//     kind = "modal"     recordings of hammer hits alone, or with scene, planes, tension_of,
//                        EI_of, EA_of, damping_of: one or both of
//                        a [test.table] with columns tension (none: one state), measured,
//                        models = { label = column, ... }; and recordings of hammer hits: force
//                        (channel), responses (default: every other), sensors = { channel = sensor
//                        of the scene } where names differ, load (of the scene, that was struck),
//                        direction ([x, y, z], struck and measured along it), band, estimator
//                        ("h1", "h2", "hv"), force_window (s after the pulse begins),
//                        exponential_window (level at the end of the block), max_order
//     kind = "tension"   length (m), length_std, mass_per_length (kg/m), mass_per_length_std,
//     mass_of
//                        ("installed", "unstretched"), EI (N m2), EI_std, EA (N), EA_std (none:
//                        fitted, or a strain of 0.001), inclination (degrees), ends ("compare",
//                        "pinned", "clamped", "springs"), plane ("in", "out", "any"), missed,
//                        false (probabilities of a mode not seen, of a false one); one or more of
//                        frequencies (Hz) with frequency_std (Hz), measured (a table of modes, or
//                        UFF 55) with column, and recordings of its motion: channels, band,
//                        max_peaks (a channel)
//     [test.reference]   tension (N) of a tension test, EA, damping_ratio of an axial test as known
//     otherwise, and what they are:
//                        name = "published" (default), "truth", ...
//     [[test.recording]] see recording_group.h
//   [[fit]]              name, title, tests = [modal tests], hold_out, model_std, starts,
//                        reference_name ("earlier value"), predicts = [decay tests that it has not
//                        seen and is laid over], and
//     [[fit.parameter]]  name, of = [scene parameters that share the value], factors, per_state,
//                        start, prior, prior_std or prior_std_percent (of each state's own value),
//                        low, high, reference (an earlier value)
//
// Every key is checked like a scene's; the scenes and tables it names are read and checked too.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/campaign_file/recording_group.h"
#include "apps/campaign_file/report_details.h"
#include "apps/results/result_table.h"
#include "ident/axial/axial_test.h"
#include "ident/bending/beam_ends.h"
#include "ident/campaign/beam_section.h"
#include "ident/campaign/tension_campaign.h"
#include "ident/stiffness/strand.h"
#include "ident/update/model_update.h"
#include "model/scene/scene.h"

namespace rigfit::apps {

/// How a value of a scene is known.
struct ValueOrigin {
  enum class Kind { published, inferred, assumed };
  std::string parameter;  ///< such as "cable.EI"
  Kind kind = Kind::assumed;
  std::string how;
};
[[nodiscard]] const char* name_of(ValueOrigin::Kind kind);

struct CampaignScene {
  std::string name;
  std::string file;
  model::Scene scene;
  std::vector<ValueOrigin> origins;
};

/// Published or earlier results of one test, by tension where it has a column for it.
struct ResultColumns {
  ResultTable table;
  std::optional<std::size_t> tension, EI, measured;
  std::vector<std::pair<std::string, std::size_t>> models;  ///< label, column
};

/// How hammer hits were recorded and are to be analysed.
struct HammerTest {
  std::string force;
  std::vector<std::string> responses;          ///< channels; empty: every other one
  std::map<std::string, std::string> sensors;  ///< channel -> sensor of the scene
  std::string load;                            ///< of the scene; empty: its only impact
  std::string estimator = "h1";
  double force_window_s = 0;         ///< 0: by the noise on the force
  double exponential_end_level = 0;  ///< 0: none
  int max_order = 0;                 ///< of the stabilisation diagram; 0: the method's own
};

/// A beam that is bent without tension.
struct BentBeam {
  ident::BeamEnds ends = ident::BeamEnds::clamped;
  ident::BeamSection section;
};

struct CampaignTest {
  enum class Kind { bending, axial, decay, modal, tension };
  std::string name;
  std::string title;
  Kind kind = Kind::modal;
  double span_m = 0;              ///< bending
  double span_std_m = 0;          ///< its standard uncertainty
  double tension_zero_std_N = 0;  ///< bending: of the tension cell's zero
  // Bending: relative standard uncertainties of calibration.
  double tension_calibration_std = 0, load_calibration_std = 0, deflection_calibration_std = 0;
  /// Bending: names of the channels; empty: as `rigfit bending` finds them.
  std::string tension_channel, load_channel, deflection_channel;
  std::optional<BentBeam> beam;  ///< bending without tension
  ident::AxialSetup axial;
  std::vector<std::string> channels;  ///< axial: one or none; decay
  std::optional<std::pair<double, double>> band_hz;
  std::optional<std::size_t> scene;            ///< modal, decay: index of the scene
  bool in_plane = true, out_of_plane = false;  ///< modal: what the test was made to see
  std::vector<std::string> tension_of;         ///< scene parameters that take a state's tension
  std::vector<std::string> EI_of;              ///< scene parameters that take EI at that tension
  /// Modal: struck and measured along this, whatever the scene says; unit vector.
  std::optional<Eigen::Vector3d> direction;
  std::vector<std::string> EA_of;               ///< scene parameters that take the axial test's EA
  std::vector<std::string> damping_of;          ///< scene parameters that take its damping ratio
  HammerTest hammer;                            ///< modal with recordings; decay: load, sensors
  std::optional<ident::TensionInputs> tension;  ///< tension: all but the recordings themselves
  std::optional<ResultColumns> results;
  std::vector<RecordingGroup> recordings;
  std::map<std::string, double> reference;  ///< values as known otherwise, by quantity
  std::string reference_name = "published";

  /// One plane only: what every mode it shows lies in, leakage apart.
  [[nodiscard]] std::optional<model::ModePlane> plane() const;
};
[[nodiscard]] const char* name_of(CampaignTest::Kind kind);

struct FitParameter {
  ident::FreeParameter free;
  std::optional<double> reference;  ///< an earlier value, shown beside the one found
};

struct CampaignFit {
  std::string name, title;
  std::vector<std::size_t> tests;
  std::vector<FitParameter> parameters;
  std::vector<std::size_t> predicts;  ///< decay tests shown with what was found
  bool hold_out = false;
  double model_std = 0;  ///< relative, in frequency
  int starts = 4;
  std::string reference_name = "earlier value";
};

struct Campaign {
  std::string file;
  std::string title, source, description;
  ReportDetails report;
  std::optional<ident::StrandGeometry> strand;
  std::vector<CampaignScene> scenes;
  std::vector<CampaignTest> tests;
  std::vector<CampaignFit> fits;
  std::vector<std::string> inputs;  ///< every file read
};

/// Throws model::SceneError.
[[nodiscard]] Campaign read_campaign(const std::filesystem::path& path);
/// The same from text; `path` is named in messages, and what the text names lies beside it.
[[nodiscard]] Campaign parse_campaign(std::string_view text, const std::filesystem::path& path);

}  // namespace rigfit::apps
