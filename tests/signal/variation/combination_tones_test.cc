#include "signal/variation/combination_tones.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <utility>

#include "signal/numerics/numbers.h"

namespace rigfit::signal::combination_tones_test {
namespace {
using Complex = std::complex<double>;

/// A mode with a peak of 1 at receptance, of one response and input.
IdentifiedMode mode_at(Complex pole, double peak) {
  IdentifiedMode mode;
  mode.pole_rad_s = pole;
  mode.frequency_hz.value = std::abs(pole) / kTwoPi;
  mode.damping_ratio.value = -pole.real() / std::abs(pole);
  mode.shape = Eigen::VectorXcd::Constant(1, peak * -pole.real());
  mode.participation = Eigen::VectorXcd::Ones(1);
  return mode;
}

ModalModel model_with(Complex third, double peak) {
  ModalModel model;
  for (const auto& [pole, size] : {std::pair{Complex(-0.3, 45), 1.0},
                                   std::pair{Complex(-1.2, 236), 1.0}, std::pair{third, peak}}) {
    model.modes.push_back(mode_at(pole, size));
  }
  return model;
}

TEST(CombinationTones, SumsAndDifferencesOfTwoModesAreNamed) {
  EXPECT_NE(combination_doubt(model_with({-1.5, 281}, 0.05), 2, 0), "");
  EXPECT_NE(combination_doubt(model_with({-1.5, 191}, 0.05), 2, 0), "");
  EXPECT_NE(combination_doubt(model_with({-0.6, 90}, 0.05), 2, 0), "");
}

TEST(CombinationTones, AMoreDampedPoleUnderAModeIsNamed) {
  EXPECT_NE(combination_doubt(model_with({-3.6, 236.5}, 0.2), 2, 0), "");
}

// Strong poles, poles beside the sums in frequency or decay rate, and neighbours of like damping
// are modes; so are those that make the sums.
TEST(CombinationTones, OthersAreModes) {
  EXPECT_EQ(combination_doubt(model_with({-1.5, 281}, 0.5), 2, 0), "");
  EXPECT_EQ(combination_doubt(model_with({-1.5, 283}, 0.05), 2, 0), "");
  EXPECT_EQ(combination_doubt(model_with({-0.7, 281}, 0.05), 2, 0), "");
  EXPECT_EQ(combination_doubt(model_with({-1.3, 236.9}, 0.2), 2, 0), "");
  EXPECT_EQ(combination_doubt(model_with({-3.6, 236.5}, 0.5), 2, 0), "");
  for (const std::size_t r : {std::size_t{0}, std::size_t{1}}) {
    EXPECT_EQ(combination_doubt(model_with({-1.5, 281}, 0.05), r, 0), "");
  }
}

}  // namespace
}  // namespace rigfit::signal::combination_tones_test
