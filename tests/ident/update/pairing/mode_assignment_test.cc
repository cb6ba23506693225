#include "ident/update/pairing/mode_assignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rigfit::ident::mode_assignment_test {
namespace {

using model::ModePlane;

std::vector<PairingMode> modes(const std::vector<double>& hz) {
  std::vector<PairingMode> list;
  for (const double f : hz) {
    PairingMode mode;
    mode.frequency_hz = f;
    mode.plane = ModePlane::in;
    list.push_back(mode);
  }
  return list;
}

// One pair, one mode in between that was not measured, one false one: the sum of the header's
// terms.
TEST(ModeAssignment, LikelihoodIsTheSumOfItsParts) {
  const AssignmentOptions options;
  const double s = 0.01;
  const auto measured = modes({10, 17, 30});
  const auto result =
      assign_modes(measured, {s, s, s}, modes({10.1, 20, 30}), std::nullopt, options);
  ASSERT_EQ(result.pairs.size(), 2U);
  EXPECT_EQ(result.unpaired_measured, std::vector<int>{1});
  ASSERT_EQ(result.missed.size(), 1U);
  EXPECT_EQ(result.missed[0].model, 1);
  // All equally visible: the strongest's own visibility.
  const double v = 1 / (1 + options.visible_ratio * options.visible_ratio);
  const double seen = (1 - options.missed) * (options.leaked + (1 - options.leaked) * v);
  const double normal =
      -2 * std::log(s * std::sqrt(2 * M_PI)) - 0.5 * std::pow(std::log(1.01) / s, 2);
  const double expected = normal + 2 * std::log((1 - options.false_mode) * seen) +
                          std::log(options.false_mode) + std::log(1 - seen);
  EXPECT_NEAR(result.log_likelihood, expected, 1e-9);
}

// Below the lowest measured mode, too, a visible mode counts as missed; an invisible one hardly,
// and none where the test did not look.
TEST(ModeAssignment, VisibleModesBelowTheMeasuredOnesAreCharged) {
  const AssignmentOptions options;
  const auto measured = modes({10, 20});
  const std::vector<double> stds{0.01, 0.01};
  auto modelled = modes({2, 10, 20});
  for (auto& mode : modelled) mode.visibility = 1;
  const auto charged = assign_modes(measured, stds, modelled, std::nullopt, options);
  EXPECT_NEAR(charged.log_missed, std::log(1 - charged.missed.at(0).probability), 1e-12);
  modelled[0].visibility = 1e-6;
  const auto unseen = assign_modes(measured, stds, modelled, std::nullopt, options);
  EXPECT_NEAR(unseen.log_missed, std::log(1 - (1 - options.missed) * options.leaked), 1e-6);
  EXPECT_TRUE(unseen.missed.empty());
  modelled[0].visibility = 1;
  const auto outside = assign_modes(measured, stds, modelled, {{5, 50}}, options);
  EXPECT_NEAR(outside.log_missed, 0, 1e-9);
}

}  // namespace
}  // namespace rigfit::ident::mode_assignment_test
