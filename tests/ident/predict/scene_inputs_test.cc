#include "ident/predict/scene_inputs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "ident/update/model_update.h"

namespace rigfit::ident::scene_inputs_test {
namespace {

/// A horizontal cantilever, weightless: f goes with sqrt(EI / m).
model::Scene cantilever() {
  model::Scene scene;
  scene.gravity.setZero();
  scene.nodes.resize(2);
  scene.nodes[0].name = "foot";
  scene.nodes[0].support.kind = model::Support::Kind::clamped;
  scene.nodes[1].name = "tip";
  scene.nodes[1].position = {1, 0, 0};
  model::Member beam;
  beam.name = "beam";
  beam.kind = model::Member::Kind::beam;
  beam.nodes = {"foot", "tip"};
  beam.segments = 20;
  beam.mass_per_length = 2;
  beam.EA = 1e7;
  beam.EI = {100, 100};
  beam.GJ = 100;
  scene.members.push_back(beam);
  return scene;
}

const std::string kMass = "beam.mass_per_length";

FittedParameters stiffness(double std) {
  FittedParameters fitted;
  fitted.parameters = {{"beam.EI", 100}};
  fitted.covariance = Eigen::MatrixXd::Constant(1, 1, std * std);
  return fitted;
}

double relative_std(const FittedParameters& fitted) {
  const auto prediction = predict_modes(cantilever(), fitted, {});
  return prediction.modes.front().frequency_hz.std / prediction.modes.front().frequency_hz.value;
}

TEST(SceneInputs, AddInSquaresWhereTheFitDoesNotKnowThem) {
  auto fitted = stiffness(2);  // 2 % of EI: 1 % of f
  const auto added = add_scene_inputs(cantilever(), {{kMass, {}, 0.03, true}}, fitted);
  EXPECT_FALSE(added.front().of_fit);
  EXPECT_NEAR(relative_std(fitted), std::hypot(0.01, 0.015), 1e-5);
}

TEST(SceneInputs, CountOnceWhereTheFitHadThem) {
  // EI fitted to frequencies of the same beam with the mass known to 3 %: EI goes with the mass,
  // and the frequencies of the very same beam do not depend on it.
  UpdateOptions options;
  options.inputs = {{kMass, {{0, kMass, 0.03 * 2}}}};
  options.segment_uncertainty = false;
  UpdateState state;
  state.scene = cantilever();
  for (const auto& mode : model::analyse_modes(state.scene).modes) {
    if (mode.plane != model::ModePlane::in || state.measured.size() == 3) continue;
    MeasuredMode one;
    one.frequency_hz = {mode.frequency_hz, 1e-4 * mode.frequency_hz};
    one.plane = mode.plane;
    state.measured.push_back(one);
  }
  FreeParameter EI;
  EI.name = "beam.EI";
  const auto fit = update_model({state}, {EI}, options);
  const auto fitted = fitted_parameters(fit, {EI});
  ASSERT_EQ(fitted.inputs.size(), 1u);
  EXPECT_NEAR(fitted.inputs[0].change[0] / fitted.parameters[0].value, 0.03, 1e-3);
  auto once = fitted;
  const auto added = add_scene_inputs(cantilever(), {{kMass, {}, 0.06}}, once);
  EXPECT_TRUE(added.front().of_fit);
  auto twice = fitted;
  twice.inputs.clear();
  (void)add_scene_inputs(cantilever(), {{kMass, {}, 0.06}}, twice);
  const auto in_plane = [](const FittedParameters& with) {
    for (const auto& mode : predict_modes(cantilever(), with, {}).modes) {
      if (mode.mode.plane == model::ModePlane::in) {
        return mode.frequency_hz.std / mode.frequency_hz.value;
      }
    }
    return 0.0;
  };
  EXPECT_LT(in_plane(once), 0.002);
  EXPECT_NEAR(in_plane(twice), 0.015 * std::sqrt(2.0), 1e-3);
}

TEST(SceneInputs, AFittedParameterKeepsItsFit) {
  auto fitted = stiffness(2);
  const auto added = add_scene_inputs(cantilever(), {{"beam.EI", 50.0, 10}}, fitted);
  EXPECT_TRUE(added.front().fitted);
  EXPECT_EQ(fitted.parameters.size(), 1u);
  EXPECT_THROW((void)add_scene_inputs(cantilever(), {{kMass, {}, 0}}, fitted),
               std::invalid_argument);
}

}  // namespace
}  // namespace rigfit::ident::scene_inputs_test
