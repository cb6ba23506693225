#include "ident/predict/scene_prediction.h"

#include "ident/update/model_update.h"
#include "model/frfs/frf_synthesis.h"
#include "model/linear/modal_analysis.h"
#include "tests/ident/update/fit_data.h"
#include "tests/test.h"

namespace rigfit::ident::scene_prediction_test {

/// A horizontal cantilever, weightless: f goes with sqrt(EI / m).
model::Scene cantilever() {
  auto scene = model::testing::level_cantilever(100, 2, 20);
  scene.members[0].damping_ratio = 0.01;
  scene.loads = {model::testing::impact({"tip", "", 0}, {0, -1, 0}, 1, 1e-3)};
  scene.sensors = {{"tip", {"tip", "", 0}, {0, 1, 0}, {}}};
  return scene;
}

/// Parameters with values and standard uncertainties that are independent.
FittedParameters fitted_to(std::vector<KnownParameter> parameters, const Eigen::VectorXd& std) {
  return {.parameters = std::move(parameters), .covariance = std.cwiseAbs2().asDiagonal()};
}

FittedParameters stiffness(double std, double value = 100) {
  return fitted_to({{"beam.EI", value}}, Eigen::VectorXd::Constant(1, std));
}

FittedParameters two(double EI_std, double m_std, double correlation) {
  auto fitted =
      fitted_to({{"beam.EI", 121}, {"beam.mass_per_length", 2.2}}, Eigen::Vector2d(EI_std, m_std));
  fitted.covariance(0, 1) = fitted.covariance(1, 0) = correlation * EI_std * m_std;
  return fitted;
}

TEST(ScenePrediction, LinearPropagationIsTheClosedForm) {
  // ln f = (ln EI - ln m) / 2 + const: var ln f = (u^2 + v^2 - 2 r u v) / 4.
  const double u = 0.01, v = 0.02, r = 0.6;
  const auto prediction = predict_modes(cantilever(), two(u * 121, v * 2.2, r), {});
  ASSERT_EQ(prediction.modes.size(), 6u);
  const double expected = std::sqrt(u * u + v * v - 2 * r * u * v) / 2;
  const auto before = model::analyse_modes(cantilever());
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& f = prediction.modes[i].frequency_hz;
    EXPECT_NEAR(f.value / before.modes[i].frequency_hz, std::sqrt(1.21 / 1.1), 1e-6);
    EXPECT_NEAR(f.std / f.value / expected, 1, 1e-4);
    EXPECT_NEAR(std::log(prediction.modes[i].frequency_hz.high / f.value),
                1.959963984540054 * expected, 1e-5);
  }
}

// Segments left to the program: the frequencies of `modes`, and the std by the derivatives of a
// chain as fine as asked. Differences over 1.96 standard uncertainties of EI (0.3 %) and tension
// (0.2 %) err by a sixth of the square of these.
TEST(ScenePrediction, AutoGivesTheFrequenciesOfModes) {
  model::Scene scene = model::testing::paper_cable(200, 0.5972, 0);
  scene.accuracy = 1e-6;
  const auto fitted =
      fitted_to({{"cable.tension", 200}, {"cable.EI", 0.5972}}, Eigen::Vector2d(0.2, 1e-3));
  const auto prediction = predict_modes(scene, fitted, {});
  model::ModesOptions options{.error_estimate = false};
  const auto modes = model::analyse_modes(scene, options).modes;
  const auto chain =
      model::analyse_mode_sensitivities(scene, {"cable.tension", "cable.EI"}, options);
  ASSERT_EQ(prediction.modes.size(), modes.size());
  std::vector<bool> taken(modes.size(), false);
  for (std::size_t i = 0; i < modes.size(); ++i) {
    EXPECT_EQ(prediction.modes[i].frequency_hz.value, modes[i].frequency_hz);
    std::size_t k = 0;
    while (taken[k] || chain.analysis.modes[k].plane != modes[i].plane) ++k;
    taken[k] = true;
    const Eigen::RowVectorXd rate = chain.frequency.row(static_cast<Index>(k));
    const double std = std::sqrt((rate * fitted.covariance * rate.transpose()).value());
    EXPECT_NEAR(prediction.modes[i].frequency_hz.std / std, 1, 2e-4) << i;
  }
}

TEST(ScenePrediction, OneParameterGivesTheExactInterval) {
  // A tip mass of about nothing to much, its logarithm normal: the frequency falls with it, so that
  // the interval's ends are the frequencies at those of the mass.
  auto scene = cantilever();
  const auto prediction =
      predict_modes(scene, fitted_to({{"tip.mass", 0.5}}, Eigen::VectorXd::Constant(1, 0.5)), {});
  const auto& first = prediction.modes[0];
  for (const auto& [end_hz, k] : {std::pair{first.frequency_hz.high, -1.959963984540054},
                                  {first.frequency_hz.low, 1.959963984540054}}) {
    scene.nodes[1].mass = 0.5 * std::exp(k);
    EXPECT_NEAR(model::analyse_modes(scene).modes[0].frequency_hz / end_hz, 1, 1e-9);
  }
}

TEST(ScenePrediction, NamesAreMapped) {
  auto fitted = two(1, 0.01, 0);
  fitted.parameters[0].name = "pole.EI";
  const auto partly = predict_modes(cantilever(), fitted, {});
  EXPECT_EQ(partly.not_used, std::vector<std::string>{"pole.EI"});
  fitted.parameters[0].targets = {"beam.EI"};
  EXPECT_TRUE(predict_modes(cantilever(), fitted, {}).not_used.empty());
  fitted.parameters[0].targets.clear();
  fitted.parameters[1].name = "pole.mass";
  EXPECT_THAT([&] { (void)predict_modes(cantilever(), fitted, {}); },
              ::testing::ThrowsMessage<std::invalid_argument>(
                  AllOf(HasSubstr("pole.EI"), HasSubstr("beam.EI"))));
}

TEST(ScenePrediction, HoldsMeasurementsAgainstIt) {
  const auto prediction = predict_modes(cantilever(), two(0.02 * 121, 0, 0), {});
  const double f = prediction.modes[0].frequency_hz.value;
  const auto mode = testing::mode_of(1.005 * f, 0, prediction.modes[0].mode.plane);
  MeasuredMode far = mode;
  far.frequency_hz.value = 1.05 * prediction.modes[2].frequency_hz.value;
  const auto held = held_against(prediction, {mode, far});
  EXPECT_TRUE(held[0].inside);
  EXPECT_FALSE(held[1].inside);
}

TEST(ScenePrediction, AutoSegmentsGiveTheIntervalThatGivenSegmentsGive) {
  const auto fitted =
      fitted_to({{"cable.tension", 60}, {"cable.EI", 0.5}}, Eigen::Vector2d(6, 0.1));
  const auto left = predict_modes(model::testing::paper_cable(60, 0.5, 0), fitted);
  const auto given = predict_modes(model::testing::paper_cable(60, 0.5, 60), fitted);
  ASSERT_EQ(left.modes.size(), 6u);
  ASSERT_EQ(given.modes.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    // 60 segments err by less than 1e-4.
    const double f = given.modes[i].frequency_hz.value;
    EXPECT_NEAR(left.modes[i].frequency_hz.low, given.modes[i].frequency_hz.low, 3e-4 * f) << i;
    EXPECT_NEAR(left.modes[i].frequency_hz.high, given.modes[i].frequency_hz.high, 3e-4 * f) << i;
    EXPECT_NEAR(left.modes[i].frequency_hz.std, given.modes[i].frequency_hz.std, 3e-4 * f) << i;
  }
}

const std::string kMass = "beam.mass_per_length";

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
  UpdateOptions options{.inputs = {{kMass, {{0, kMass, 0.03 * 2}}}}};
  options.segment_uncertainty = false;
  UpdateState state{.scene = cantilever()};
  state.measured = testing::modes_of(state.scene, model::ModePlane::in, 3, 1e-4);
  FreeParameter EI{.name = "beam.EI"};
  const auto fit = update_model({state}, {EI}, options);
  const auto& found = fit.parameters.front();
  FittedParameters fitted{{{found.name, found.value}}, fit.covariance};
  for (const auto& term : found.budget) add_effect(term.source, 0, term.change, fitted);
  EXPECT_NEAR(fitted.inputs.at(kMass)[0] / fitted.parameters[0].value, 0.03, 1e-3);
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

}  // namespace rigfit::ident::scene_prediction_test
