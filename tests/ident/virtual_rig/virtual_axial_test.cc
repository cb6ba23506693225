#include "ident/virtual_rig/virtual_axial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace rigfit::ident::virtual_axial_test {
namespace {

VirtualAxialTest light_test() {
  VirtualAxialTest test;
  test.EA_N = 221780;
  test.mass_per_length_kg_m = 0.16667;
  test.length_m = 1.0;
  test.hung_mass_kg = 2.2;
  test.damping_ratio = 0.017;
  return test;
}

// k = (M + mc/3) w^2 is the rod's Rayleigh quotient; what it leaves out is of second order in mc/M:
// the exact series k_rod = EA/L (1 - x/3 - x^2/45 ...), x = (bL)^2 = about mc/M = 0.076, so x^2/45
// = 1.3e-4.
TEST(VirtualAxial, ContinuousRodNearsTheLumpedOneFromBelow) {
  const auto test = light_test();
  const double k = test.EA_N / test.length_m;
  const double lumped = std::sqrt(k / (test.hung_mass_kg + 0.16667 / 3)) *
                        std::sqrt(1 - 0.017 * 0.017) / (2 * std::numbers::pi);
  const double exact = axial_truth(test).frequency_hz;
  EXPECT_LT(exact, lumped);
  EXPECT_NEAR(exact, lumped, 1.3e-4 * lumped);
}

TEST(VirtualAxial, AStiffAdapterVanishesAndASoftOneTakesOver) {
  auto test = light_test();
  const double bare = axial_truth(test).frequency_hz;
  test.adapter_stiffness_N_m = 1e15;
  EXPECT_NEAR(axial_truth(test).frequency_hz, bare, 1e-9 * bare);
  test.adapter_stiffness_N_m =
      10;  // cable is 22000 times stiffer: only the adapter's spring is left
  const double soft = std::sqrt(10 / 2.2) / (2 * std::numbers::pi);
  EXPECT_NEAR(axial_truth(test).frequency_hz, soft, 3e-4 * soft);
}

// Without any disturbance the record is the weight, then a decaying sinusoid about it: its
// successive extremes obey the logarithmic decrement.
TEST(VirtualAxial, RecordDecaysWithTheStatedDampingRatio) {
  auto test = light_test();
  test.swing_rad = 0;
  test.sample_rate_hz = 50000;
  Random random = random_stream(1, 0);
  const auto recording = virtual_axial_record(test, random);
  const auto& x = recording.channels[0].samples;
  const double weight = 2.2 * 9.80665;
  EXPECT_NEAR(x[0], weight, 1e-9);
  std::vector<double> peaks;
  for (Eigen::Index i = 25100; i + 1 < x.size() && peaks.size() < 11; ++i) {
    if (x[i] > x[i - 1] && x[i] >= x[i + 1]) peaks.push_back(x[i] - weight);
  }
  ASSERT_EQ(peaks.size(), 11u);
  const double decrement = std::log(peaks.front() / peaks.back()) / 10;
  // Peaks are met within half a sample of 1000 a cycle: relative error (pi/1000)^2 / 2 = 5e-6 each.
  EXPECT_NEAR(decrement, 2 * std::numbers::pi * 0.017 / std::sqrt(1 - 0.017 * 0.017), 2e-6);
}

TEST(VirtualAxial, SameSeedSameRecordAndBadValuesRefused) {
  auto test = light_test();
  test.load_cell = {0.05, 0.5, 0.1, 0.05, 0, 500, 16};
  Random a = random_stream(7, 3), b = random_stream(7, 3), c = random_stream(8, 3);
  const auto first = virtual_axial_record(test, a);
  EXPECT_EQ(first.channels[0].samples, virtual_axial_record(test, b).channels[0].samples);
  EXPECT_NE(first.channels[0].samples, virtual_axial_record(test, c).channels[0].samples);
  test.hung_mass_kg = 0;
  EXPECT_THROW((void)axial_truth(test), std::invalid_argument);
}

}  // namespace
}  // namespace rigfit::ident::virtual_axial_test
