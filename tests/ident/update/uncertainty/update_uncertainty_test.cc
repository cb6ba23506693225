#include "ident/update/uncertainty/update_uncertainty.h"

#include "ident/update/model_update.h"
#include "tests/ident/update/fit_data.h"
#include "tests/test.h"

namespace rigfit::ident::update_uncertainty_test {

using model::ModePlane;

// A clamped cable: frequencies err by second order in the segments.
model::Scene cable(double tension, double EI, int segments) {
  auto scene = model::testing::paper_cable(tension, EI, segments);
  scene.nodes[1].position.x() = 1.2;
  for (auto& node : scene.nodes) node.support.kind = model::Support::Kind::clamped;
  return scene;
}

// Without weight frequencies go with the root of EI over mass, and nothing else.
model::Scene cantilever(double EI) {
  auto scene = testing::beam(EI, 0, 24);
  scene.gravity.setZero();
  return scene;
}

using testing::modes_of;

void add_noise(std::vector<MeasuredMode>& modes, std::uint64_t seed) {
  Normal normal(seed);
  for (auto& mode : modes) mode.frequency_hz.value += mode.frequency_hz.std * normal();
}

// EI goes with the mass that is taken as known; the frequencies that the fit gives do not.
TEST(UpdateUncertainty, AnInputReachesParametersButNotWhatTheFitMakesUpFor) {
  UpdateState state{"beam", cantilever(2.0), modes_of(cantilever(2.1), ModePlane::in, 4, 1e-3)};
  UpdateOptions options = testing::plain_options();
  options.inputs = {{"mass", {{0, "beam.mass_per_length", 0.02 * 0.3}}}};
  const auto result = update_model({state}, {{"beam.EI_z"}}, options);
  const auto& EI = result.parameters[0];
  ASSERT_EQ(EI.budget.size(), 2U);
  EXPECT_EQ(EI.budget[1].source, "mass");
  EXPECT_NEAR(EI.budget[1].std / EI.value, 0.02, 1e-4);  // its differences are exact to 0.02^2 / 4
  EXPECT_NEAR(EI.budget[0].std / EI.value, 2e-3 / std::sqrt(4), 1e-5);
  EXPECT_NEAR(EI.std, std::hypot(EI.budget[0].std, EI.budget[1].std), 1e-12);
  for (const auto& pair : result.pairs) {
    EXPECT_NEAR(pair.model_std_hz / pair.model_hz, 1e-3 / std::sqrt(4), 1e-5);
  }
}

// With q = ln EI and frequencies that go with its root the cost is a parabola: the ends are
// EI exp(-+ 1.96 std).
TEST(UpdateUncertainty, ProfileOfAParabolaIsTheLinearInterval) {
  UpdateState state{"beam", cantilever(2.0), modes_of(cantilever(2.1), ModePlane::in, 4, 1e-2)};
  add_noise(state.measured, 5);
  const std::vector<FreeParameter> free{{"beam.EI_z"}, {"beam.EI_y"}};
  const auto result = update_model({state}, free, {.starts = 1, .segment_uncertainty = false});
  const auto& EI = result.parameters[0];
  ASSERT_TRUE(EI.interval_by_profile);  // since EI_y is open
  const double reach = result.coverage_factor * result.identifiability.std[0];
  EXPECT_NEAR(std::log(EI.high / EI.value), reach, 1e-2 * reach);  // ends to 1e-2 of the deviance
  EXPECT_NEAR(std::log(EI.low / EI.value), -reach, 1e-2 * reach);
  EXPECT_TRUE(std::isnan(result.parameters[1].low));  // nothing measured moves with EI_y
}

// What is known to 1 % is as skew as the mass that it goes with, which is not.
TEST(UpdateUncertainty, AnIntervalBendsWithThatOfAnother) {
  std::mt19937_64 random(0);
  const auto modes = testing::modes_of(testing::beam(2.1, 0.002), ModePlane::in, 5, 1e-3, &random);
  const auto result = update_model({{"beam", testing::beam(1.7, 0.01), modes}},
                                   {{"beam.EI_z"}, {"tip.mass"}}, testing::plain_options());
  const auto& EI = result.parameters[0];
  EXPECT_LT(result.identifiability.std[0], 0.02);
  EXPECT_TRUE(EI.interval_by_profile);
  EXPECT_LT(EI.high - EI.value, 0.85 * (EI.value - EI.low));
}

TEST(UpdateUncertainty, AHeldOutStatesPredictionHasItsUncertainty) {
  std::vector<UpdateState> states;
  for (const double tension : {100.0, 200.0, 300.0}) {
    UpdateState state{std::to_string(tension), cable(tension, 0.57, 12),
                      modes_of(cable(tension, 0.6, 12), ModePlane::out, 4, 1e-3)};
    add_noise(state.measured, 7);
    states.push_back(state);
  }
  UpdateOptions options = testing::plain_options();
  options.hold_out = true;
  const auto all = update_model(states, {{"cable.EI"}}, options).held;
  ASSERT_EQ(all.size(), 3U);
  for (const auto& held : all) {
    ASSERT_EQ(held.pairs.size(), 4U);
    for (const auto& pair : held.pairs) {
      EXPECT_GT(pair.model_std_hz, 0);
      // Four times what data, model and each of the other states may be off.
      const double data = 1e-3 * pair.measured_hz;
      EXPECT_LT(std::abs(pair.model_hz - pair.measured_hz),
                4 * std::hypot(pair.model_std_hz, data));
      EXPECT_LT(pair.model_std_hz, 3 * data);
    }
  }
}

// A load cell's reading of each state with its uncertainty: readings to 1e-4 beside frequencies
// that are known to 10 % keep the tensions where they were read, to that.
TEST(Priors, AtEachStatesOwnValue) {
  std::vector<UpdateState> states;
  for (const double tension : {150.0, 250.0}) {
    states.push_back({"", cable(tension, 0.6, 20),
                      modes_of(cable(1.05 * tension, 0.6, 20), ModePlane::out, 3, 0.1)});
  }
  UpdateOptions options = testing::plain_options();
  FreeParameter tension{.name = "cable.tension"};
  tension.per_state = true;
  tension.prior_relative_std = 1e-4;
  const auto result = update_model(states, {tension}, options);
  ASSERT_EQ(result.parameters.size(), 2u);
  EXPECT_NEAR(result.parameters[0].value, 150, 4e-4 * 150);
  EXPECT_NEAR(result.parameters[1].value, 250, 4e-4 * 250);
  EXPECT_NEAR(result.parameters[1].std, 250e-4, 0.05 * 250e-4);
}

// Frequencies of a cable of another EI than the model's: a misfit that grows with the mode.
UpdateResult tension_beside_uncertain_stiffness(double EI_std) {
  UpdateState state{.scene = cable(200, 0.6, 60),
                    .measured = modes_of(cable(201, 0.6072, 60), ModePlane::in, 6, 1e-4)};
  UpdateOptions options{.segment_uncertainty = false,
                        .inputs = {{"EI", {{0, "cable.EI", EI_std}}}}};
  return update_model({state}, {FreeParameter{"cable.tension"}}, options);
}

TEST(UpdateUncertainty, AMisfitThatAnInputExplainsIsNoErrorOfTheModel) {
  const auto fit = tension_beside_uncertain_stiffness(0.006);  // off by 1.2 of it
  EXPECT_FALSE(fit.fit.ruled_out());
  EXPECT_EQ(fit.fit.model_std, 0);
  // 1.2^2 of the input, nothing else: the data are exact. The second order of a change of 1.2 % is
  // 2e-5 in frequency, a fifth of a standard deviation.
  EXPECT_NEAR(fit.fit.chi2, 1.44, 0.15);
  const auto& tension = fit.parameters.at(0);
  EXPECT_NEAR(tension.value, 201, 2 * tension.std);
  EXPECT_EQ(fit.variance_factor, 1);
}

TEST(UpdateUncertainty, AMisfitThatAnInputCannotExplainStillRulesTheModelOut) {
  const auto fit = tension_beside_uncertain_stiffness(0.0006);
  EXPECT_TRUE(fit.fit.ruled_out());
  EXPECT_GT(fit.fit.model_std, 0);
}

}  // namespace rigfit::ident::update_uncertainty_test
