// What a campaign file says (campaign.h).
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
#include "ident/axial/axial_identification.h"
#include "ident/bending/beam_ends.h"
#include "ident/campaign/single_tests/beam_section.h"
#include "ident/campaign/single_tests/tension_campaign.h"
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
  std::string load;                            ///< the scene's load; empty: its only impact
  std::string estimator = "h1";
  double force_window_s = 0;         ///< 0: by the noise on the force
  double exponential_end_level = 0;  ///< 0: none
  int max_order = 0;                 ///< order of the stabilisation diagram; 0: the method's own
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
  double span_m = 0;                  ///< bending
  double span_std_m = 0;              ///< its standard uncertainty
  double tension_zero_std_N = 0;      ///< bending: of the tension cell's zero
  double clamp_stiffness_Nm_rad = 0;  ///< bending: 1 over the std of its flexibility; 0: rigid
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

}  // namespace rigfit::apps
