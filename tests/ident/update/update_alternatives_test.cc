#include "ident/update/assignment/update_alternatives.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "ident/update/model_update.h"
#include "model/scene/read_scene.h"

namespace rigfit::ident {
namespace {

// The virtual laboratory's rig: its truth, or what was known of it before its tests.
model::Scene rig(const std::string& folder, double tension) {
  const std::filesystem::path laboratory = RIGFIT_TESTDATA "/virtual_laboratory";
  model::Scene scene = model::read_scene((laboratory / folder / "rig.toml").string());
  for (auto& member : scene.members) member.segments = 30;
  for (const std::string cable : {"left cable.", "right cable."}) {
    model::set_parameter(scene, cable + "tension", tension);
    model::set_parameter(scene, cable + "EI", 0.674);
    model::set_parameter(scene, cable + "EA", 205000);
  }
  return scene;
}

// Modes in the plane below 60 Hz as a very good test gives them: damping ratios to 2e-4.
std::vector<MeasuredMode> measured_modes(double tension) {
  const model::Scene truth = rig("truth", tension);
  std::vector<MeasuredMode> measured;
  model::ModesOptions options;
  options.count = 24;
  options.damped = true;
  for (const auto& mode : model::analyse_modes(truth, options).modes) {
    if (mode.plane != model::ModePlane::in || mode.frequency_hz > 60) continue;
    const double f = mode.frequency_hz, damping = mode.damping_ratio;
    measured.push_back({{f, 2e-6 * f},
                        {damping, 2e-4 * damping},
                        mode.plane,
                        mode.sensor_shape.cast<std::complex<double>>()});
  }
  return measured;
}

std::vector<FreeParameter> free_parameters() {
  FreeParameter tension{"tension", {"left cable.tension", "right cable.tension"}};
  tension.per_state = true;
  return {{"beam.EI_z"},
          {"tip.mass"},
          tension,
          {"cable damping", {"left cable.damping_ratio", "right cable.damping_ratio"}},
          {"beam.damping_ratio"}};
}

// Damping ratios are known far better than any model far from the answer gives them. They must not
// lead there: the answer was lost then by changes of 1e-11 in what was measured.
TEST(FindAnswers, RoundingOfTheMeasuredModesChangesNothing) {
  const std::vector<double> tensions{200, 300};
  std::vector<UpdateState> exact;
  for (const double tension : tensions) {
    exact.push_back({"", rig("scenes", tension), measured_modes(tension)});
    exact.back().band_hz = {2.0, 60.0};
    ASSERT_GE(exact.back().measured.size(), 7U);
  }
  UpdateOptions options;
  options.starts = 1;
  options.model_relative_std = 1e-3;
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  for (int draw = 0; draw < 20; ++draw) {
    SCOPED_TRACE(draw);
    auto states = exact;
    for (auto& state : states) {
      for (auto& mode : state.measured) mode.frequency_hz.value *= 1 + 1e-11 * normal(random);
    }
    const UpdateProblem problem(states, free_parameters(), options);
    int fits = 0;
    std::string failure;
    const auto answers = find_answers(problem, options, fits, failure);
    ASSERT_EQ(answers.size(), 1U) << failure;
    const auto& answer = answers.front();
    const double EI = problem.coordinates()[0].value(answer.solution.q[0]);
    EXPECT_NEAR(EI, 2.17, 1e-4 * 2.17);  // the model is that which made the modes
    EXPECT_EQ(answer.solution.matches.unpaired_measured, 0);
    EXPECT_TRUE(answer.solution.converged);
  }
}

}  // namespace
}  // namespace rigfit::ident
