// The states of a modal test (one a tension) with the model's answer to each, before anything is
// shown. What was measured comes from recordings, from a table of published results, or both.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/report/modal/recorded_modal.h"
#include "apps/report/parts/bending_part.h"
#include "ident/campaign/axial_campaign.h"
#include "ident/update/mode_pairing.h"
#include "ident/update/model_update.h"
#include "model/linear/modal_analysis.h"

namespace rigfit::apps {

/// What the scenes take from tests made before.
struct KnownValues {
  StiffnessCurve EI;
  std::optional<ident::AxialKnowledge> axial;
};

/// The scene with the sensors and loads that a test had, in the order of its FRFs.
struct Instrumented {
  model::Scene scene;
  std::vector<Eigen::Index> response, input;  ///< of the FRFs, by sensor and load of `scene`
};

struct MeasuredRow {
  double measured_hz = 0;               ///< NaN: dash
  double std_hz = 0;                    ///< NaN: not known
  double damping = 0, damping_std = 0;  ///< NaN: not measured
  Origin origin = Origin::published;
  Eigen::VectorXcd shape;           ///< at the instrumented scene's sensors; empty: not measured
  std::vector<double> models_hz;    ///< by published model; NaN: dash
  std::optional<std::size_t> mode;  ///< index of the modelled mode paired with it
  double mac = 0;                   ///< of that pair; NaN: fewer than two sensors
  bool other_plane = false;         ///< that mode lies in a plane the test was not made to see
};

struct ModalState {
  std::optional<double> tension_N;
  std::optional<double> EI_Nm2;
  Instrumented rig;
  const ident::ModalTestState* recorded = nullptr;
  model::ModalAnalysis analysis;
  double wall_s = 0;  ///< of the analysis
  /// What the number of segments costs in frequency: median over the modes (where two modes cross,
  /// the number of segments may swap them, and the largest error says nothing).
  double segments_error = 0;
  std::vector<MeasuredRow> rows;
};

/// Modes of the scene at every state of the test, and their pairing. `recorded` must outlive it.
[[nodiscard]] std::vector<ModalState> modal_states(
    const Campaign& campaign, const CampaignTest& test, const KnownValues& known,
    const std::vector<ident::ModalTestState>& recorded);

/// The scene as the test has it at one tension.
[[nodiscard]] model::Scene scene_at(const Campaign& campaign, const CampaignTest& test,
                                    const KnownValues& known, std::optional<double> tension_N);

/// `scene` with the sensors and loads of these FRFs; those that it does not have are left out.
[[nodiscard]] Instrumented instrumented(model::Scene scene, const CampaignTest& test,
                                        const ident::ModalTestState& recorded);

/// Pairs rows with modes of an analysis of the instrumented scene: fills mode, mac, other_plane.
void pair_rows(const CampaignTest& test, const model::ModalAnalysis& analysis,
               std::vector<MeasuredRow>& rows);

struct RmsError {
  double value = 0;  ///< rms relative error; NaN without rows
  int rows = 0;
};
/// Over the rows of the test's own recordings where there are any, else over the published ones;
/// leakage from the other plane counts as paired.
[[nodiscard]] RmsError rms_of_model(const std::vector<ModalState>& states);
[[nodiscard]] RmsError rms_of_published(const std::vector<ModalState>& states, std::size_t model);

}  // namespace rigfit::apps
