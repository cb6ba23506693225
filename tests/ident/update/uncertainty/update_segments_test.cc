// What the number of segments does to updated parameters, against closed forms and fine models.
#include "ident/update/model_update.h"
#include "model/frfs/frf_synthesis.h"
#include "tests/ident/update/fit_data.h"
#include "tests/test.h"

namespace rigfit::ident::update_segments_test {

using model::ModePlane;

// Struck at a quarter; the sensor is at 0.4.
model::Scene cable(double gravity, const std::string& support, double tension, double EI,
                   int segments) {
  auto scene = model::testing::paper_cable(tension, EI, segments);
  scene.gravity = {0, -gravity, 0};
  if (support == "clamped") {
    for (auto& node : scene.nodes) node.support.kind = model::Support::Kind::clamped;
  }
  scene.members[0].damping_ratio = 0.005;
  scene.loads = {model::testing::impact({"", "cable", 0.25}, {0, 0, 1}, 0, 0)};
  scene.sensors = {{"mid", {"", "cable", 0.4}, {0, 0, 1}, {}}};
  return scene;
}

// A pinned string with bending stiffness, no gravity: omega^2 = (T k^2 + EI s k^4) s / m with
// k = n pi / L and s = 1 + T / EA, as mass and EI are per unstretched length.
double closed_form_hz(double tension, double EI, int n) {
  const double k = n * kPi / 2.4, s = 1 + tension / 221780.0;
  return std::sqrt((tension * k * k + EI * s * k * k * k * k) * s / 0.16667) / (2 * kPi);
}

/// `count` frequencies of each, known to a relative `std`, and off by that with `normal`.
std::vector<UpdateState> four_tensions(double std, Normal* normal, int count = 6) {
  std::vector<UpdateState> states;
  for (const double T : {100.0, 200.0, 300.0, 400.0}) {
    auto& state = states.emplace_back();
    state.name = std::to_string(T), state.scene = cable(0, "pinned", 1.1 * T, 0.8, 0);
    state.scene.sensors.clear();  // which do not see every mode
    for (int n = 1; n <= count; ++n) {
      const double hz = closed_form_hz(T, 0.6, n), off = normal ? std * (*normal)() : 0;
      state.measured.push_back(testing::mode_of(hz * (1 + off), std * hz, ModePlane::out));
    }
  }
  return states;
}

FreeParameter each_tension() {
  FreeParameter tension{"cable.tension"};
  tension.per_state = true;
  return tension;
}

// Frequencies of the closed form without noise: the model's for vanishing segments, to a tenth of
// their standard uncertainty by its own estimate, which is mostly far above the error.
TEST(UpdateSegments, ClosedFormFrequenciesGiveTheirOwnParameters) {
  for (const int count : {6, 19}) {  // 30 segments give the 19th 8 % too low
    const auto left = update_model(four_tensions(1e-4, nullptr, count),
                                   {{"cable.EI"}, each_tension()}, {.starts = 1});
    ASSERT_EQ(left.status, UpdateStatus::converged) << left.message;
    for (std::size_t p = 0; p < 5; ++p) {
      const auto& parameter = left.parameters[p];
      const double truth = p == 0 ? 0.6 : 100.0 * static_cast<double>(p);
      EXPECT_LT(std::abs(parameter.value - truth), parameter.std / 3) << p << " of " << count;
      EXPECT_NEAR(parameter.value, truth, (p == 0 ? 1e-3 : 1e-5) * truth) << p << " of " << count;
    }
    EXPECT_LT(left.rms_relative_error, 1e-6);
  }
}

// Along the valley of tension, EI and springs the error of the segments is taken off all the same.
TEST(UpdateSegments, AFlatValleyIsNoMisfit) {
  auto scene = cable(0, "springs", 195, 0.62, 60);
  for (auto& node : scene.nodes) {
    node.support.kind = model::Support::Kind::elastic;
    node.support.translational.setConstant(kInf);
    node.support.rotational = {kInf, 3, 3};
  }
  std::mt19937_64 random(1);
  const auto modes = testing::modes_of(scene, ModePlane::out, 8, 2e-4, &random);
  for (auto& node : scene.nodes) node.support.rotational = {kInf, 5, 5};
  scene.members[0].segments = 0;
  const auto result =
      update_model({{"cable", scene, modes}},
                   {{"cable.EI"},
                    {"cable.tension"},
                    {.name = "springs", .targets = {"left.rotational_y", "right.rotational_y"}}});
  EXPECT_GT(result.fit.p_value, 0.01);
}

TEST(UpdateSegments, IntervalsHoldTheClosedFormsParameters) {
  constexpr int kSeeds = 12;
  int covered = 0;
  double EI = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    Normal normal(seed);
    const auto states = four_tensions(5e-4, &normal);
    const auto result = update_model(states, {{"cable.EI"}, each_tension()}, {.starts = 1});
    for (std::size_t p = 0; p < 5; ++p) {
      const auto& parameter = result.parameters[p];
      const double truth = p == 0 ? 0.6 : 100.0 * static_cast<double>(p);
      covered += std::abs(parameter.value - truth) <= result.coverage_factor * parameter.std;
    }
    EI += (result.parameters[0].value - 0.6) / result.parameters[0].std / kSeeds;
  }
  EXPECT_GE(covered, 52);         // of 60: 95 %, three binomial deviations
  EXPECT_LT(std::abs(EI), 0.87);  // the mean of 12 scatters by 0.29: three of these
}

// A sagging cable in its plane, data of 400 segments: near the crossover the error falls slowly.
TEST(UpdateSegments, ASaggingCableInItsPlane) {
  std::vector<UpdateState> states;
  for (const double T : {40.0, 100.0, 200.0}) {
    states.push_back(
        {std::to_string(T), cable(9.80665, "pinned", 1.05 * T, 0.7, 0),
         testing::modes_of(cable(9.80665, "pinned", T, 0.6, 400), ModePlane::in, 6, 3e-4)});
  }
  const auto result = update_model(states, {{"cable.EI"}, each_tension()}, {.starts = 1});
  ASSERT_EQ(result.status, UpdateStatus::converged) << result.message;
  const double truth[] = {0.6, 40, 100, 200};
  for (std::size_t p = 0; p < 4; ++p) {
    const auto& parameter = result.parameters[p];
    EXPECT_LT(std::abs(parameter.value - truth[p]), parameter.std / 3) << p;
  }
}

// FRFs are fitted as the segments give them: "auto" gets as many as their uncertainty asks for. The
// data have noise of the size of their error bars.
TEST(UpdateSegments, FrfsGetTheSegmentsThatTheyNeed) {
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(40, 20, 59);
  const auto truth = model::synthesize_frfs(cable(0, "clamped", 200, 0.6, 480), lines);
  MeasuredFrf frf{.frequency_hz = lines};
  frf.H.resize(40), frf.std.resize(40);
  Normal normal(1);
  for (Index k = 0; k < 40; ++k) {
    frf.H[k] = truth.H[k](0, 0);
    frf.std[k] = 0.1 * std::abs(frf.H[k]);  // 0.25 % of EI; 30 segments cost it 5 %
    frf.H[k] += frf.std[k] * Complex(normal(), normal());
  }
  const auto fit = [&](int segments) {
    UpdateState state{"cable", cable(0, "clamped", 200, 0.65, segments), {}, {frf}};
    return update_model({state}, {{"cable.EI"}}, {.starts = 1});
  };
  const auto left = fit(0), given = fit(30), fine = fit(480);
  const double resolved = fine.parameters[0].value;
  ASSERT_EQ(left.status, UpdateStatus::converged) << left.message;
  EXPECT_LT(std::abs(left.parameters[0].value - resolved), left.parameters[0].std / 3);
  EXPECT_GT(std::abs(given.parameters[0].value - resolved), left.parameters[0].std);
}

}  // namespace rigfit::ident::update_segments_test
