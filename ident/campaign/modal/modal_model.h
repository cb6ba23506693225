// Compares a modal test with its scene: at every state of the rig the scene takes the results of
// earlier tests (EI at the tension, EA, damping), and its modes are computed and paired with
// measured ones from recordings, from a published table, or both. Other tests and fits use scenes
// in the same way (`SceneUse`).
#pragma once

#include "ident/campaign/modal/modal_campaign.h"
#include "ident/campaign/single_tests/test_recording.h"
#include "ident/stiffness/stiffness_curve.h"
#include "ident/update/problem/update_data.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/scene.h"

namespace rigfit::ident {

struct KnownValues {
  StiffnessCurve EI;             ///< empty: no bending test
  Estimate EA_N, damping_ratio;  ///< from the axial test; NaN: none
};

/// A scene and its parameters (such as "cable.EI") that take a state's tension and known values.
struct SceneUse {
  model::Scene scene;
  std::vector<std::string> tension_of, EI_of, EA_of, damping_of;
};

/// The scene that stands for the rig at a tension (empty: as built). Throws model::SceneError for a
/// parameter that the scene does not have.
[[nodiscard]] model::Scene scene_at(const SceneUse& use, const KnownValues& known,
                                    std::optional<double> tension_N);

/// A state of a fit, at that tension.
struct StateUse {
  SceneUse use;
  std::optional<double> tension_N;
};

/// Uncertainties of EI, EA and damping in a fit's states, as inputs of it: each source (of EI,
/// each term of the curve's uncertainty) moves all states together.
[[nodiscard]] std::vector<UncertainInput> known_inputs(const KnownValues& known,
                                                       const std::vector<StateUse>& states);

/// A frequency of a table, with those of published models beside it.
struct PublishedMode {
  std::optional<double> tension_N;
  double measured_hz = kNaN;      ///< NaN: dash
  std::vector<double> models_hz;  ///< by published model; NaN: dash
};

/// A hammer test; with a scene, its modes are compared with the model's.
struct ModalInputs {
  std::string name;                       ///< used in the names of its states
  std::vector<TestRecording> recordings;  ///< may be empty: published modes only
  ModalTestOptions options;
  std::vector<PublishedMode> published;
  std::optional<SceneUse> scene;
  /// Direction of hits and sensors, overriding the scene's; unit vector.
  std::optional<Vector3d> direction;
  std::map<std::string, std::string> sensors;  ///< channel -> sensor, where names differ
  std::optional<model::ModePlane> plane;       ///< plane of all measured modes, except for leakage
};

/// The scene with the sensors and loads that a test had, in the order of its FRFs.
struct Instrumented {
  model::Scene scene;
  std::vector<Index> response, input;  ///< FRFs' sensor and load, as indices in `scene`
};

/// `scene` with the sensors and loads of these FRFs; those missing in the scene are left out.
[[nodiscard]] Instrumented instrumented(model::Scene scene, const ModalInputs& test,
                                        const ModalTestState& recorded);

/// A measured mode, its shape at the instrumented scene's sensors; a frequency of NaN is a dash.
struct MeasuredRow : MeasuredMode {
  Origin origin = Origin::published;
  std::vector<double> models_hz;    ///< by published model; NaN: dash
  std::optional<std::size_t> mode;  ///< index of the modelled mode paired with it
  double mac = kNaN;                ///< MAC of that pair; NaN: fewer than two sensors
  bool other_plane = false;         ///< that mode lies in another plane than the test's
};

struct ModalState {
  std::optional<double> tension_N;
  std::optional<double> EI_Nm2;
  Instrumented rig;
  const ModalTestState* recorded = nullptr;
  model::ModalAnalysis analysis;
  /// Relative error in frequency due to the number of segments, median over the modes (where two
  /// modes cross, the number of segments may swap them, so that the largest error is meaningless).
  double segments_error = 0;
  std::vector<MeasuredRow> rows;
};

/// The state whose tension is nearest, within a part in 200, or that has none either; empty: there
/// is none. `tensions`: by state.
[[nodiscard]] std::optional<std::size_t> state_at(
    const std::vector<std::optional<double>>& tensions, std::optional<double> tension_N);
/// "200 N", or "as built" without a tension.
[[nodiscard]] std::string state_label(std::optional<double> tension_N);

/// Modes of the test's scene at every state that has modes, by rising tension, and their pairing.
/// `recorded` must outlive the result. A published mode belongs to the state at its tension.
[[nodiscard]] std::vector<ModalState> modal_states(const ModalInputs& test,
                                                   const KnownValues& known,
                                                   const std::vector<ModalTestState>& recorded);

struct RmsError {
  double value = 0;  ///< rms relative error; NaN without rows
  int rows = 0;
};
/// Rms error over the rows from the test's own recordings, or else over the published ones; leakage
/// from the other plane counts as paired. Of a published model: over all rows that it has a
/// frequency of.
[[nodiscard]] RmsError rms_error(const std::vector<ModalState>& states,
                                 std::optional<std::size_t> published = std::nullopt);

}  // namespace rigfit::ident
