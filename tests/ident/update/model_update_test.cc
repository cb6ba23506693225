#include "ident/update/model_update.h"

#include "model/scene/scene.h"
#include "tests/ident/update/fit_data.h"
#include "tests/test.h"

namespace rigfit::ident::model_update_test {

using model::ModePlane;

// A vertical cantilever with a tip mass.
model::Scene beam(double EI, double mass_per_length, double tip_mass, double gravity = 9.80665) {
  auto scene = testing::beam(EI, tip_mass);
  scene.members[0].mass_per_length = mass_per_length;
  scene.gravity.y() = -gravity;
  return scene;
}

model::Scene cable(double tension, double EI) {
  return model::testing::paper_cable(tension, EI, 12);
}

// A mass that the scene has none of: no logarithm and no relative step to begin with.
TEST(UpdateModel, FindsAMassThatStartsAtZero) {
  std::mt19937_64 random(5);
  UpdateState state{"beam", beam(2.1, 0.3, 0.0),
                    testing::modes_of(beam(2.1, 0.3, 0.02), ModePlane::in, 5, 0, &random)};
  for (auto& mode : state.measured) mode.frequency_hz.std = 1e-3 * mode.frequency_hz.value;
  const auto result = update_model({state}, {{"tip.mass"}});
  ASSERT_EQ(result.status, UpdateStatus::converged) << result.message;
  EXPECT_EQ(result.parameters[0].start, 0);
  EXPECT_NEAR(result.parameters[0].value, 0.02, 1e-3 * 0.02);
  EXPECT_GT(result.parameters[0].std, 0);
  EXPECT_TRUE(result.parameters[0].identifiable);
}

// EI and the tip's mass from starts ten times too large and too small, in all four ways: the answer
// of a start at the truth. A tenth of the stiffness under ten times the mass buckles: the search
// begins elsewhere. Ceres stops at 1e-9 of cost and step.
TEST(UpdateModel, StartsOffByTenGiveTheSameAnswer) {
  std::mt19937_64 random(21);
  const auto data = testing::modes_of(beam(2.1, 0.3, 0.02), ModePlane::in, 5, 1e-3, &random);
  const std::vector<FreeParameter> free{{"beam.EI_z"}, {"tip.mass"}};
  const auto near = update_model({{"beam", beam(2.1, 0.3, 0.02), data}}, free);
  for (const double by_EI : {0.1, 10.0}) {
    for (const double by_mass : {0.1, 10.0}) {
      const UpdateState state{"beam", beam(2.1 * by_EI, 0.3, 0.02 * by_mass), data};
      const auto found = update_model({state}, free);
      ASSERT_EQ(found.status, UpdateStatus::converged) << by_EI << by_mass << found.message;
      EXPECT_EQ(found.pairs.size(), 5U);
      for (const std::size_t k : {0, 1}) {
        EXPECT_NEAR(found.parameters[k].value, near.parameters[k].value,
                    0.01 * near.parameters[k].std);
      }
    }
  }
}

// Without gravity and tip mass only EI / m acts: to twice 1e-3 over the root of five, 3.5 times.
TEST(UpdateModel, TheRatioOfTwoThatOnlyActTogetherIsRight) {
  std::mt19937_64 random(22);
  UpdateState state{"beam", beam(1.5, 0.3, 0, 0),
                    testing::modes_of(beam(2.1, 0.3, 0, 0), ModePlane::in, 5, 1e-3, &random)};
  const auto found = update_model({state}, {{"beam.EI_z"}, {"beam.mass_per_length"}});
  EXPECT_FALSE(found.parameters[0].identifiable || found.parameters[1].identifiable);
  ASSERT_EQ(found.open.size(), 1U);
  EXPECT_THAT(found.open[0], AllOf(HasSubstr("beam.EI_z"), HasSubstr("beam.mass_per_length")));
  EXPECT_NEAR(found.parameters[0].value / found.parameters[1].value, 7,
              7 * 3.5 * 2e-3 / std::sqrt(5.0));
}

TEST(UpdateModel, APriorSeparatesThem) {
  std::mt19937_64 random(2);
  UpdateState state{"beam", beam(1.5, 0.3, 0, 0), {}};
  state.measured = testing::modes_of(beam(2.1, 0.3, 0, 0), ModePlane::in, 5, 1e-3, &random);
  FreeParameter mass{"beam.mass_per_length"};
  mass.prior = signal::Estimate{0.3, 0.003};
  const auto result = update_model({state}, {{"beam.EI_z"}, mass}, {.segment_uncertainty = false});
  ASSERT_TRUE(result.parameters[0].identifiable);
  EXPECT_TRUE(std::isnan(result.parameters[1].std_from_data));
  // EI = 7 m: its 1 % comes from the prior, 2 * 1e-3 / sqrt(5) from the data.
  EXPECT_NEAR(result.parameters[0].std / result.parameters[0].value, 0.01, 0.002);
  EXPECT_NEAR(result.parameters[0].value, 2.1, 3 * 0.02);
  EXPECT_NEAR(result.correlation(0, 1), 1, 0.05);
}

// Frequencies without an uncertainty of their own that fit far better than was assumed say nothing
// about what else was stated: EI and mass go together, so both keep the prior's 1 %.
TEST(UpdateModel, AssumedUncertaintiesThatAreTooLargeLeaveAPriorAsItIs) {
  std::mt19937_64 random(2);
  UpdateState state{"beam", beam(1.5, 0.3, 0, 0), {}};
  state.measured = testing::modes_of(beam(2.1, 0.3, 0, 0), ModePlane::in, 5, 0, &random);
  for (auto& mode : state.measured) mode.frequency_hz.std = kNaN;
  FreeParameter mass{"beam.mass_per_length"};
  mass.prior = signal::Estimate{0.3, 0.003};
  const auto result = update_model({state}, {{"beam.EI_z"}, mass}, {.segment_uncertainty = false});
  for (const auto& parameter : result.parameters) {
    EXPECT_GT(parameter.std / parameter.value, 0.0099);
  }
}

TEST(UpdateModel, AParameterWithoutInfluenceIsNamedAlone) {
  std::mt19937_64 random(3);
  UpdateState state{"beam", beam(2.0, 0.3, 0.02), {}};
  state.measured = testing::modes_of(beam(2.1, 0.3, 0.02), ModePlane::in, 4, 1e-3, &random);
  const auto result = update_model({state}, {{"beam.EI_z"}, {"beam.EI_y"}});
  EXPECT_TRUE(result.parameters[0].identifiable);
  EXPECT_FALSE(result.parameters[1].identifiable);
  ASSERT_EQ(result.open.size(), 1U);
  EXPECT_EQ(result.open[0], "the data do not determine beam.EI_y");
}

TEST(UpdateModel, AStrayModeAndAnOutlierAreLeftUnpaired) {
  std::mt19937_64 random(4);
  UpdateState state{"beam", beam(2.6, 0.3, 0.02), {}};
  state.measured = testing::modes_of(beam(2.1, 0.3, 0.02), ModePlane::in, 5, 1e-3, &random);
  const double between =
      0.5 * (state.measured[1].frequency_hz.value + state.measured[2].frequency_hz.value);
  state.measured.push_back({.frequency_hz = {between, 0.001 * between}, .plane = ModePlane::in});
  state.measured[3].frequency_hz.value *= 1.05;  // fifty standard deviations
  const auto result = update_model({state}, {{"beam.EI_z"}, {"tip.mass"}});
  // Both cost less as false modes than as the model's error for all; the modelled mode that the
  // outlier belongs to is listed as one that the test should have seen.
  EXPECT_NEAR(result.parameters[0].value, 2.1, 2 * result.parameters[0].std);
  EXPECT_LT(result.parameters[0].std, 0.1);
  EXPECT_EQ(result.fit.model_std, 0);
  EXPECT_EQ(result.unpaired.size(), 3U);
  EXPECT_EQ(result.pairs.size(), 4U);
}

// Antisymmetric modes in plane hardly depend on EA. Modes 2, 4, 6 at four tensions, 0.3 %: they
// determine EI; EA is not determined, or its interval is wide and holds the truth.
TEST(UpdateModel, EvenModesDoNotDecideEA) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::mt19937_64 random(seed);
    std::vector<UpdateState> states;
    for (const double tension : {100.0, 150.0, 200.0, 300.0}) {
      UpdateState state{std::to_string(tension) + " N", cable(tension, 0.6), {}};
      for (const ModePlane plane : {ModePlane::in, ModePlane::out}) {
        const auto all = testing::modes_of(state.scene, plane, 6, 3e-3, &random);
        for (const std::size_t k : {1, 3, 5}) state.measured.push_back(all[k]);
      }
      states.push_back(std::move(state));
    }
    const auto result = update_model(states, {{"cable.EI"}, {"cable.EA"}});
    EXPECT_NEAR(result.parameters[0].value, 0.6, 4 * result.parameters[0].std) << seed;
    const auto& EA = result.parameters[1];
    // An upper end that is not a number is open.
    EXPECT_TRUE(!EA.identifiable || (EA.low < 221780 && !(EA.high < 2 * 221780)))
        << seed << ": " << EA.low << " " << EA.high;
  }
}

std::size_t unpaired_measured(const UpdateResult& result) {
  return static_cast<std::size_t>(std::count_if(result.unpaired.begin(), result.unpaired.end(),
                                                [](const auto& lone) { return !lone.missing(); }));
}

std::vector<UpdateState> cable_states(double EI_off, double tension_off, double std,
                                      std::mt19937_64& random) {
  std::vector<UpdateState> states;
  for (double T : {100.0, 200.0, 300.0}) {
    UpdateState state{std::to_string(static_cast<int>(T)) + " N",
                      cable(tension_off * T, EI_off * 0.6),
                      testing::modes_of(cable(T, 0.6), ModePlane::out, 5, std, &random)};
    states.push_back(state);
  }
  return states;
}

TEST(UpdateModel, SharedAndPerStateParameters) {
  std::mt19937_64 random(5);
  const auto states = cable_states(2, 1.1, 1e-3, random);
  FreeParameter tension{"cable.tension"};
  tension.per_state = true;
  const auto result = update_model(states, {{"cable.EI"}, tension});
  ASSERT_EQ(result.status, UpdateStatus::converged) << result.message;
  ASSERT_EQ(result.parameters.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    const double truth = k == 0 ? 0.6 : 100.0 * static_cast<double>(k);
    EXPECT_NEAR(result.parameters[k].value, truth, 3.5 * result.parameters[k].std) << k;
    EXPECT_GT(result.parameters[k].std, 0);
  }
  EXPECT_EQ(result.parameters[2].state, 1);
  EXPECT_THAT(result.parameters[2].name, HasSubstr("200 N"));
}

// One mode, none, the same one five times, one at an absurd place: an answer without uncertainty or
// a status that says why there is none, and never a value that is not finite.
TEST(UpdateModel, TooLittleDataGetNoUncertainty) {
  std::mt19937_64 random(8);
  UpdateState state{"beam", beam(2.3, 0.3, 0.02), {}};
  const auto data = testing::modes_of(beam(2.1, 0.3, 0.02), ModePlane::in, 3, 0, &random);
  const std::vector<FreeParameter> free{{"beam.EI_z"}, {"tip.mass"}};
  const UpdateOptions options = testing::plain_options();
  const auto finite = [](const UpdateResult& result) {
    for (const auto& parameter : result.parameters) {
      if (!std::isfinite(parameter.value)) return false;
    }
    return true;
  };
  state.measured = {data[1]};
  state.measured[0].frequency_hz.std = 0.01;
  const auto one = update_model({state}, free, options);
  EXPECT_EQ(one.status, UpdateStatus::too_little_data);
  EXPECT_FALSE(one.parameters[0].identifiable && one.parameters[1].identifiable);
  EXPECT_FALSE(one.open.empty());
  EXPECT_TRUE(finite(one));

  state.measured.clear();
  const auto none = update_model({state}, free, options);
  EXPECT_EQ(none.status, UpdateStatus::no_model);
  EXPECT_FALSE(none.message.empty());
  EXPECT_TRUE(finite(none));

  state.measured.assign(5, data[1]);
  const auto same = update_model({state}, free, options);
  EXPECT_TRUE(finite(same));
  EXPECT_EQ(same.pairs.size(), 1U);
  EXPECT_EQ(unpaired_measured(same) + same.pairs.size(), 5U);
  EXPECT_FALSE(same.parameters[0].identifiable && same.parameters[1].identifiable);

  MeasuredMode absurd{.frequency_hz = {1e9, 1e6}};
  state.measured = {absurd};
  EXPECT_EQ(update_model({state}, free, options).status, UpdateStatus::no_model);
  absurd.frequency_hz.value = 0;
  state.measured = {absurd};
  EXPECT_THROW((void)update_model({state}, free, options), std::invalid_argument);
}

TEST(UpdateModel, WrongNamesAndImpossibleRigsAreSaid) {
  std::mt19937_64 random(8);
  UpdateState state{"beam", beam(2.1, 0.3, 0.02), {}};
  state.measured = testing::modes_of(state.scene, ModePlane::in, 3, 1e-3, &random);
  EXPECT_THROW((void)update_model({state}, {{"beam.EIz"}}), model::SceneError);
  EXPECT_THROW((void)update_model({}, {{"beam.EI_z"}}), std::invalid_argument);
  EXPECT_THROW((void)update_model({state}, {}), std::invalid_argument);
  // A column that buckles under its own weight from every start near it.
  UpdateState soft{"soft", beam(1e-4, 0.3, 5), state.measured};
  const auto result = update_model({soft}, {{"beam.EI_z"}});
  EXPECT_EQ(result.status, UpdateStatus::no_model);
  EXPECT_FALSE(result.message.empty());
}

/// A cantilever of EI 1.8 with four sensors in its plane.
model::Scene beam(double tip_mass) {
  auto scene = testing::beam(1.8, tip_mass);
  for (const double at : {0.25, 0.5, 0.75, 1.0}) {
    auto& sensor = scene.sensors.emplace_back();
    sensor.place = {"", "beam", at};
    sensor.direction = {1, 0, 0};
  }
  return scene;
}

std::vector<Finding> findings_of(const std::vector<MeasuredMode>& modes) {
  return fit_findings(
      update_model({{"beam", beam(0.03), modes}}, {{"beam.EI_z"}}, testing::plain_options()));
}

// A tip of 100 g in place of 30 g makes the first mode some 15 % lower against the higher ones,
// of 31 g by a fifth of a per cent.
TEST(FitFindings, WithoutStatedUncertaintiesAModelThatIsFarOffIsRuledOut) {
  for (const bool off : {false, true}) {
    const auto truth = beam(off ? 0.1 : 0.031);
    auto modes = testing::modes_of(truth, model::ModePlane::in, 5, 1e-3);
    for (auto& mode : modes) mode.frequency_hz.std = std::nan("");
    EXPECT_EQ(rigfit::testing::says(findings_of(modes), "model_ruled_out"), off);
  }
}

// The second and the third sensor's cables exchanged.
TEST(FitFindings, ShapesThatContradictTheModelAreToldOnce) {
  const auto truth = beam(0.03);
  for (const bool swapped : {false, true}) {
    auto modes = testing::modes_of(truth, model::ModePlane::in, 5, 1e-3);
    std::size_t next = 0;
    for (const auto& natural : model::analyse_modes(truth, {.count = 23}).modes) {
      if (natural.plane != model::ModePlane::in || next == modes.size()) continue;
      auto& shape = modes[next++].shape = natural.sensor_shape.cast<std::complex<double>>();
      if (swapped) std::swap(shape[1], shape[2]);
    }
    const auto findings = findings_of(modes);
    EXPECT_EQ(std::ranges::count(findings, "shapes_disagree", &Finding::code), swapped ? 1 : 0);
    for (const auto& finding : findings) {
      EXPECT_NE(finding.message.find("of 5 measured shapes"), std::string::npos) << finding.message;
    }
  }
}

}  // namespace rigfit::ident::model_update_test
