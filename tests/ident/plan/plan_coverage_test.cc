// Predicted against realised standard uncertainties in 200 virtual laboratories. The std of 200
// draws is known to 1 / sqrt(400) = 5 %: 15 % is three of these. Huber's loss, and the error of the
// model that an update allows for where chance alone makes a misfit of below 5 %, add up to some 10
// % where there are few modes.
#include "ident/plan/plan.h"
#include "ident/plan/plan_candidates.h"
#include "ident/update/model_update.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/read_scene.h"
#include "signal/sinusoids/damped_sinusoids.h"
#include "tests/test.h"

namespace rigfit::ident::plan_coverage_test {

constexpr int kLaboratories = 200;
constexpr double kWithin = 0.15;

model::Scene paper_cable() {
  auto scene = model::read_scene(RIGFIT_TESTDATA "/jalali2021/scenes/cable.toml");
  scene.members[0].segments = 16;
  return scene;
}

UpdateResult fitted(const std::vector<UpdateState>& states, const std::vector<FreeParameter>& free,
                    const std::vector<UncertainInput>& inputs) {
  return update_model(states, free, {.starts = 1, .segment_uncertainty = false, .inputs = inputs});
}

// Sums of the squared deviations of each parameter from its truth, and their std at the end.
struct Realised {
  std::vector<double> squares;
  int count = 0;
  void add(const UpdateResult& fit, const std::vector<PlannedParameter>& truth) {
    squares.resize(truth.size());
    for (std::size_t p = 0; p < truth.size(); ++p) {
      squares[p] += std::pow(fit.parameters[p].value - truth[p].value, 2);
    }
    ++count;
  }
  void expect_near(const std::vector<PlannedParameter>& predicted) const {
    ASSERT_EQ(count, kLaboratories);
    for (std::size_t p = 0; p < predicted.size(); ++p) {
      const double realised = std::sqrt(squares[p] / count);
      EXPECT_NEAR(realised / predicted[p].std, 1, kWithin) << predicted[p].name;
    }
  }
};

std::vector<model::NaturalMode> natural_modes(const model::Scene& scene) {
  model::ModesOptions options{.count = 26};
  options.error_estimate = options.shapes = false;
  return model::analyse_modes(scene, options).modes;
}

double frequency(const std::vector<model::NaturalMode>& modes, model::ModePlane plane, int order) {
  for (const auto& mode : modes) {
    if (mode.plane == plane && --order == 0) return mode.frequency_hz;
  }
  return 0;
}

// Each laboratory draws the frequencies about those of its own rig, whose span is off by 2 mm, and
// what an earlier test said of EA.
TEST(PlanCoverage, OfNoisyModesWithAnInputAndAPrior) {
  const auto scene = paper_cable();
  const auto states = plan_states(scene, {100}, {});
  constexpr double kSpanStd = 0.002, kPriorStd = 0.02;
  std::vector<FreeParameter> free{{"cable.EI"}, {"cable.tension"}, {"cable.EA"}};
  free[1].per_state = true;
  const double EA = scene.members[0].EA;
  free[2].prior = signal::Estimate{EA, kPriorStd * EA};
  PlanOptions options{.model_relative_std = 1e-3,
                      .inputs = {{"span", {{0, "right.x", kSpanStd}, {1, "right.x", kSpanStd}}}}};
  const auto plan = plan_measurements(
      states, free, {{"cable.EI", 0.015}, {"cable.tension", 0.002}, {"cable.EA", 0.01}}, options);
  for (const auto& parameter : plan.parameters) ASSERT_TRUE(std::isfinite(parameter.std));

  Normal normal(11);
  Realised realised;
  for (int laboratory = 0; laboratory < kLaboratories; ++laboratory) {
    auto measured = states;
    const double off = kSpanStd * normal();
    std::vector<std::vector<model::NaturalMode>> modes;
    for (auto& state : measured) {
      auto rig = state.scene;
      model::set_parameter(rig, "right.x", model::parameter(rig, "right.x") + off);
      modes.push_back(natural_modes(rig));
    }
    for (const auto& mode : plan.modes) {
      const double f = frequency(modes[mode.state], mode.plane, mode.order) *
                       std::exp(mode.frequency_std * normal());
      measured[mode.state].measured.push_back({{f, mode.frequency_std * f}, {}, mode.plane});
      measured[mode.state].measured.back().damping_ratio.value = kNaN;
    }
    free[2].prior->value = EA * (1 + kPriorStd * normal());
    realised.add(fitted(measured, free, options.inputs), plan.parameters);
  }
  realised.expect_near(plan.parameters);
}

// From the noise of the records on: every hit's decays are simulated and fitted, the hits'
// frequencies and damping ratios averaged, and the update fits these. Damping ratios differ from
// the model's by the error that the plan allows for.
TEST(PlanCoverage, OfNoisyRecords) {
  const auto states = plan_states(paper_cable(), {}, {});
  const std::vector<FreeParameter> free{{"cable.EI"}, {"cable.tension"}, {"cable.damping_ratio"}};
  PlanOptions options{.sample_rate_hz = 256};
  options.hits = {2};
  options.durations_s = {4};
  options.noise_std = 0.5;
  const auto candidates = plan_candidates(states, free, options);
  const double kModelStd = states[0].scene.accuracy;
  // At a tenth of the span, along y: sees all modes but the fourth, whose node the hammer strikes.
  constexpr std::size_t kSensor = 2;
  const PlanTest test{0, 0, {kSensor}, 0, 0};
  const auto modes = planned_modes(candidates, {test});
  ASSERT_EQ(modes.size(), 5u);
  const Eigen::MatrixXd C = plan_covariance(candidates, modes);
  std::vector<PlannedParameter> predicted;
  for (Index p = 0; p < C.rows(); ++p) {
    const auto& coordinate = candidates.problem.coordinates()[p];
    const double value = coordinate.value(candidates.q[p]);
    predicted.push_back({{free[p].name, value, value * std::sqrt(C(p, p))}, 0, 0});
  }

  Normal normal(5);
  const double rate = options.sample_rate_hz;
  const auto samples = static_cast<Index>(rate * options.durations_s[0]);
  std::vector<Complex> poles;
  Eigen::VectorXd clean = Eigen::VectorXd::Zero(samples);
  for (const auto& mode : modes) {
    const double omega = 2 * kPi * mode.frequency_hz;
    poles.push_back(Complex(-mode.damping_ratio, 1) * omega / rate);
    const auto& all = candidates.states[0].modes;
    const auto at = std::find_if(all.begin(), all.end(), [&](const auto& one) {
      return one.plane == mode.plane && one.order == mode.order;
    });
    const double amplitude = candidates.states[0].amplitude[at - all.begin()](0, kSensor);
    for (Index j = 0; j < samples; ++j) {
      clean[j] += amplitude * std::exp(poles.back() * static_cast<double>(j)).imag();
    }
  }
  Realised realised;
  for (int laboratory = 0; laboratory < kLaboratories; ++laboratory) {
    std::vector<Complex> mean(modes.size());
    for (int hit = 0; hit < 2; ++hit) {
      Eigen::VectorXd y = clean;
      for (double& sample : y) sample += normal();
      const auto fit = signal::fit_damped_sinusoids(y, poles, {.background_terms = 0});
      ASSERT_EQ(fit.end, signal::StepsEnd::converged);
      for (std::size_t m = 0; m < modes.size(); ++m) mean[m] += 0.5 * fit.poles[m] * rate;
    }
    auto measured = states;
    for (std::size_t m = 0; m < modes.size(); ++m) {
      const double f = mean[m].imag() / (2 * kPi) * std::exp(kModelStd * normal());
      const double zeta =
          -mean[m].real() / mean[m].imag() * std::exp(options.damping_model_std * normal());
      measured[0].measured.push_back({{f, modes[m].frequency_std * f},
                                      {zeta, modes[m].damping_std * modes[m].damping_ratio},
                                      modes[m].plane});
    }
    realised.add(fitted(measured, free, {}), predicted);
  }
  realised.expect_near(predicted);
}

}  // namespace rigfit::ident::plan_coverage_test
