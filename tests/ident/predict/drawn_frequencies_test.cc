#include "ident/predict/drawn_frequencies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "ident/predict/scene_prediction.h"
#include "model/scene/read_scene.h"

namespace rigfit::ident::drawn_frequencies_test {
namespace {

model::Scene cable(double tension, double EI, const std::string& segments) {
  return model::parse_scene(R"(
accuracy = 1e-4
[[node]]
name = "left"
position = [0.0, 0.0, 0.0]
support = "pinned"
[[node]]
name = "right"
position = [2.4, 0.0, 0.0]
support = "pinned"
[[member]]
name = "cable"
kind = "cable"
nodes = ["left", "right"]
mass_per_length = 0.16667
EA = 221780.0
GJ = 0.1
segments = )" + segments + "\ntension = " +
                                std::to_string(tension) + "\nEI = " + std::to_string(EI) + "\n",
                            "cable.toml");
}

/// In-plane and out-of-plane modes whose frequencies are nearly equal and change places.
TEST(DrawnFrequencies, AreThoseOfEverySceneByItself) {
  for (const char* segments : {"\"auto\"", "20"}) {
    std::vector<model::Scene> scenes;
    for (int i = 0; i < 30; ++i) {
      scenes.push_back(cable(60 * (1 + 0.2 * std::sin(7.0 * i)), 0.5 + 0.01 * (i % 7), segments));
    }
    model::ModesOptions options;
    options.shapes = options.damped = options.error_estimate = false;
    const auto reference = model::analyse_modes(scenes[0], options).modes;
    const auto found = drawn_frequencies(scenes, reference, options, 1e-4);
    ASSERT_EQ(found.size(), scenes.size());
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      const auto alone = drawn_frequencies({&scenes[s], 1}, reference, options, 1e-4);
      ASSERT_EQ(found[s].size(), 6) << s;
      ASSERT_EQ(alone[0].size(), 6) << s;
      // Either errs by the accuracy at most.
      EXPECT_LT((found[s].array() / alone[0].array() - 1).abs().maxCoeff(), 2e-4) << s;
    }
  }
}

TEST(DrawnFrequencies, GiveTheIntervalThatGivenSegmentsGive) {
  FittedParameters fitted;
  fitted.parameters = {{"cable.tension", 60}, {"cable.EI", 0.5}};
  fitted.covariance = Eigen::Vector2d(36, 0.01).asDiagonal();
  PredictionOptions options;
  options.always_sample = true;
  const auto left = predict_modes(cable(60, 0.5, "\"auto\""), fitted, options);
  const auto given = predict_modes(cable(60, 0.5, "60"), fitted, options);
  ASSERT_EQ(left.modes.size(), 6u);
  ASSERT_EQ(given.modes.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    // The same draws; 60 segments err by less than 1e-4.
    const double f = given.modes[i].frequency_hz.value;
    EXPECT_NEAR(left.modes[i].low_hz, given.modes[i].low_hz, 3e-4 * f) << i;
    EXPECT_NEAR(left.modes[i].high_hz, given.modes[i].high_hz, 3e-4 * f) << i;
    EXPECT_NEAR(left.modes[i].frequency_hz.std, given.modes[i].frequency_hz.std, 3e-4 * f) << i;
  }
}

}  // namespace
}  // namespace rigfit::ident::drawn_frequencies_test
