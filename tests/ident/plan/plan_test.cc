#include "ident/plan/plan.h"

#include "ident/plan/plan_candidates.h"
#include "ident/update/model_update.h"
#include "signal/sinusoids/damped_sinusoids.h"
#include "tests/ident/update/hanger.h"
#include "tests/test.h"

namespace rigfit::ident::plan_test {

// A pinned hanger without gravity, struck at 0.3, with an accelerometer at 0.4.
model::Scene struck(double EI) {
  auto scene = testing::hanger(model::Support::Kind::pinned, EI);
  scene.loads = {model::testing::impact({"", "h", 0.3}, {0, -1, 0}, 500, 0.005)};
  scene.sensors = {{"s", {"", "h", 0.4}, {0, 1, 0}, {}}};
  scene.members[0].damping_ratio = 0.002;
  return scene;
}
constexpr double kStringEI = 1;  // N m2: T L^2 / EI = 5e7, pi^2 over which it moves a frequency

PlanOptions exact_model() { return {.model_relative_std = 0}; }

// T = 4 m L^2 f^2: the tension is known to twice what the frequency is. Segments: 40 of second
// order, (pi / 40)^2 / 12 of a frequency, which does not change d ln f / d ln T = 1/2.
TEST(Plan, TheTensionOfAStringFromOneFrequency) {
  auto options = exact_model();
  options.modes = 1;
  options.frequency_relative_std = 1e-3;
  options.as_drawn = true;
  const auto plan = plan_measurements(plan_states(struck(kStringEI), {}, {}), {{"h.tension"}},
                                      {{"h.tension", 0.01}}, options);
  ASSERT_EQ(plan.failure, "");
  ASSERT_EQ(plan.proposals.size(), 1u);
  EXPECT_TRUE(plan.goals[0].reached);
  EXPECT_NEAR(plan.parameters[0].std / (2e-3 * testing::kTension), 1, 1e-3);
  EXPECT_TRUE(std::isnan(plan.parameters[0].std_before));
  ASSERT_EQ(plan.modes.size(), 1u);
  const double f = std::sqrt(testing::kTension / 30) / (2 * testing::kLength);
  EXPECT_NEAR(plan.modes[0].frequency_hz / f, 1, 1e-3);
  // 0.1 % would take a frequency twice as good.
  const auto missed = plan_measurements(plan_states(struck(kStringEI), {}, {}), {{"h.tension"}},
                                        {{"h.tension", 0.001}}, options);
  EXPECT_FALSE(missed.goals[0].reached);
  EXPECT_THAT(missed.goals[0].takes, HasSubstr("2.0 times more accurate"));
}

// Frequencies of a string depend on T / m alone, in every state. The way out is a prior, here with
// the tension known to twice the goal at least less what frequencies leave.
TEST(Plan, ParametersThatActOnlyTogetherAreNamedTogether) {
  const auto states = plan_states(struck(kStringEI), {}, {});
  const std::vector<FreeParameter> free{{"h.tension"}, {"h.mass_per_length"}};
  const auto plan = plan_measurements(states, free, {{"h.mass_per_length", 0.01}});
  ASSERT_EQ(plan.not_identifiable.size(), 1u);
  EXPECT_THAT(plan.not_identifiable[0].parameters,
              UnorderedElementsAre("h.tension", "h.mass_per_length"));
  EXPECT_FALSE(plan.goals[0].reached);
  EXPECT_THAT(plan.goals[0].takes, HasSubstr("a prior: h.tension known to 5e+03"));
  auto known = free;
  known[0].prior = signal::Estimate{testing::kTension, 0.009 * testing::kTension};
  EXPECT_TRUE(plan_measurements(states, known, {{"h.mass_per_length", 0.01}}).goals[0].reached);
}

// Another length separates EI from the tension where one length of few modes does not.
TEST(Plan, AFurtherStateIsProposedWhereItIsNeeded) {
  auto options = exact_model();
  options.modes = 1;
  options.as_drawn = true;
  options.frequency_relative_std = 1e-3;
  const std::vector<FreeParameter> free{{"h.tension"}, {"h.EI"}};
  const auto scene = struck(2e5);
  const auto alone = plan_measurements(plan_states(scene, {}, {}), free, {{"h.EI", 0.1}}, options);
  EXPECT_FALSE(alone.goals[0].reached);
  const auto both = plan_measurements(plan_states(scene, {}, {3}), free, {{"h.EI", 0.1}}, options);
  EXPECT_TRUE(both.goals[0].reached);
  ASSERT_EQ(both.proposals.size(), 2u);
  EXPECT_THAT(both.proposals[0].what + both.proposals[1].what, HasSubstr("3 m"));
  EXPECT_THROW((void)plan_measurements(plan_states(scene, {}, {}), free, {{"h.x", 0.1}}),
               std::invalid_argument);
}

// Of independent data more is never less: every variance falls with every hit and sensor.
TEST(Plan, MoreHitsAndSensorsNeverWorsen) {
  const auto options = exact_model();
  const auto candidates = plan_candidates(plan_states(struck(2e5), {}, {}),
                                          {{"h.tension"}, {"h.EI"}, {"h.damping_ratio"}}, options);
  const auto variances = [&](const PlanTest& test) {
    return Eigen::VectorXd(
        plan_covariance(candidates, planned_modes(candidates, {test})).diagonal());
  };
  PlanTest test{0, 0, {0}, 0, 0};
  Eigen::VectorXd before = variances(test);
  const auto grow = [&](const char* what) {
    const Eigen::VectorXd now = variances(test);
    EXPECT_TRUE((now.array() <= before.array() * (1 + 1e-9)).all()) << what;
    before = now;
  };
  for (test.hits = 1; test.hits < options.hits.size(); ++test.hits) grow("hits");
  --test.hits;
  test.sensors.push_back(5);  // at 0.2, along y
  grow("sensors");
  test.duration = 1;
  grow("duration");
  EXPECT_LT(before.maxCoeff(), 1e-4);
}

// The covariance is that which an update of the same modes states, inputs and priors included: the
// same derivatives, except for the differences by which both take the inputs (1e-6).
TEST(Plan, PredictsWhatTheUpdateStates) {
  const auto states = plan_states(struck(2e5), {4e5}, {});
  std::vector<FreeParameter> free{{"h.tension"}, {"h.EI"}, {"h.damping_ratio"}};
  free[0].prior_relative_std = 0.05;
  free[0].per_state = true;
  PlanOptions options;
  options.inputs = {{"length", {{0, "b.x", 0.01}, {1, "b.x", 0.01}}},
                    {"mass", {{0, "h.mass_per_length", 0.1}, {1, "h.mass_per_length", 0.1}}}};
  const auto plan =
      plan_measurements(states, free, {{"h.EI", 0.01}, {"h.tension", 0.005}}, options);
  auto measured = states;
  for (const auto& mode : plan.modes) {
    measured[mode.state].measured.push_back(
        {{mode.frequency_hz, mode.frequency_std * mode.frequency_hz},
         {mode.damping_ratio, mode.damping_std * mode.damping_ratio},
         mode.plane});
  }
  const auto fit = update_model(
      measured, free, {.starts = 1, .segment_uncertainty = false, .inputs = options.inputs});
  ASSERT_EQ(fit.parameters.size(), plan.parameters.size());
  for (std::size_t p = 0; p < fit.parameters.size(); ++p) {
    EXPECT_EQ(fit.parameters[p].name,
              plan.parameters[p].name.substr(0, fit.parameters[p].name.size()));
    EXPECT_NEAR(plan.parameters[p].std / fit.parameters[p].std, 1, 1e-3) << plan.parameters[p].name;
  }
}

// What the goals do not need is not proposed: no goal asks for a second hammer or state here.
TEST(Plan, ProposesNoMoreThanIsNeeded) {
  const auto plan = plan_measurements(plan_states(struck(2e5), {4e5, 6e5}, {5}),
                                      {{"h.EI"}, {"h.tension"}}, {{"h.EI", 0.05}});
  EXPECT_TRUE(plan.goals[0].reached);
  ASSERT_EQ(plan.proposals.size(), 1u);
  EXPECT_THAT(plan.proposals[0].what, HasSubstr("as drawn"));
  EXPECT_THAT(plan.proposals[0].what, HasSubstr("5 hits of 4 s"));
}

// 16 s^2 a^3 / (fs |C|^2) of a decay that is over, 24 s^2 / (fs |C|^2 T^3) of a steady tone.
// exp(-2 a T) T^2 = 1e-15 and 1.2 a T = 1e-6 are what the limits leave out.
TEST(DecayBound, LimitsOfLongRecordsAndOfNoDamping) {
  const double a = 2, rate = 500, ratio = 30;
  const auto over = decay_information(ratio, a, 10, rate);
  EXPECT_NEAR(over.pole * 16 * a * a * a / (rate * ratio * ratio), 1, 1e-12);
  EXPECT_NEAR(over.energy / (rate * ratio * ratio / (4 * a)), 1, 1e-12);
  for (const double rate_of_decay : {0.0, 1e-7}) {
    const auto steady = decay_information(ratio, rate_of_decay, 8, rate);
    EXPECT_NEAR(steady.pole * 24 / (rate * ratio * ratio * 512), 1, 2e-6);
  }
}

// The covariance of the maximum-likelihood fit of one decay is the bound, but for terms at twice
// its frequency, of the order 1 / (w T) = 1 / 250.
TEST(DecayBound, IsTheCovarianceOfAFittedDecay) {
  const double rate = 200, T = 4, a = 0.9, omega = 2 * kPi * 10, amplitude = 3;
  const Complex pole = Complex(-a, omega) / rate;
  Eigen::VectorXd y(static_cast<Index>(rate * T));
  for (Index j = 0; j < y.size(); ++j) {
    y[j] = amplitude * std::exp(pole * static_cast<double>(j)).real();
  }
  const auto fit = signal::fit_damped_sinusoids(y, std::vector{pole}, {.background_terms = 0});
  ASSERT_EQ(fit.unit_covariance.rows(), 4);
  const double variance = 1 / decay_information(amplitude, a, T, rate).pole;
  EXPECT_NEAR(fit.unit_covariance(2, 2) * rate * rate / variance, 1, 0.01);
  EXPECT_NEAR(fit.unit_covariance(3, 3) * rate * rate / variance, 1, 0.01);
}

// Simpson's rule with 2000 intervals errs by (w h)^4 < 1e-9 here.
TEST(DecayBound, TheImpulseOfAHalfSineIsItsFourierTransform) {
  const double peak = 20, duration = 0.003;
  for (const double omega : {1.0, 500.0, kPi / duration, 2500.0}) {
    Complex sum = 0;
    const int n = 2000;
    for (int k = 0; k <= n; ++k) {
      const double t = duration * k / n, weight = k == 0 || k == n ? 1 : k % 2 == 1 ? 4 : 2;
      sum += weight * peak * std::sin(kPi * t / duration) * std::polar(1.0, -omega * t);
    }
    EXPECT_NEAR(half_sine_impulse(peak, duration, omega), std::abs(sum) * duration / (3 * n), 1e-9)
        << omega;
  }
}

}  // namespace rigfit::ident::plan_test
