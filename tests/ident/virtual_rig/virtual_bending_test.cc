#include "ident/virtual_rig/virtual_bending.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace rigfit::ident::virtual_bending_test {
namespace {

VirtualBendingTest quiet_test() {
  VirtualBendingTest test;
  test.EI_Nm2 = 0.5972;
  test.span_m = 1.0;
  test.tension_N = 200;
  test.friction_load_N = 0;
  test.frame_stiffness_N_m = 0;
  return test;
}

// Without tension to speak of, a clamped beam: d = Q l^3 / (192 EI); g's next term is x^2/10
// = 2.5e-6 here.
TEST(VirtualBending, WithoutTensionIsAClampedBeam) {
  auto test = quiet_test();
  test.tension_N = 6e-5;
  Random random = random_stream(1, 0);
  const auto recording = virtual_bending_record(test, random);
  const auto& load = recording.channels[1].samples;
  const auto& deflection = recording.channels[2].samples;
  const Eigen::Index peak = recording.samples() / 4;  // middle of the first of two cycles
  EXPECT_NEAR(load[peak], 10, 1e-5);
  EXPECT_NEAR(deflection[peak], 10 / (192 * test.EI_Nm2), 4e-6 * 10 / (192 * test.EI_Nm2));
}

TEST(VirtualBending, TensionOnlyGrowsAndFrictionOpensALoop) {
  auto test = quiet_test();
  test.frame_stiffness_N_m = 2e4;
  test.friction_load_N = 0.05;
  Random random = random_stream(1, 0);
  const auto recording = virtual_bending_record(test, random);
  const auto& tension = recording.channels[0].samples;
  const auto& load = recording.channels[1].samples;
  EXPECT_GE(tension.minCoeff(), test.tension_N);
  EXPECT_GT(tension.maxCoeff(), test.tension_N);
  // At the same deflection, half-way up and half-way down, the loads differ by twice the friction.
  const Eigen::Index cycle = (recording.samples() - 1) / 2;
  EXPECT_NEAR(load[cycle / 4] - load[3 * cycle / 4], 2 * test.friction_load_N, 1e-9);
}

TEST(SensorModel, QuantisesClipsAndAddsTheTransverseSignal) {
  Random random = random_stream(1, 0);
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(101, -2, 2);
  const Eigen::VectorXd t = Eigen::VectorXd::Ones(101);
  SensorModel sensor;
  sensor.full_scale = 1;
  sensor.bits = 3;
  const Eigen::VectorXd y = recorded(x, Eigen::VectorXd(), 0.01, sensor, random);
  EXPECT_EQ(y.minCoeff(), -1);
  EXPECT_EQ(y.maxCoeff(), 1);
  EXPECT_EQ((y * 4).array().round().matrix(), y * 4);  // 2^3 steps over +-1
  SensorModel tilted;
  tilted.transverse_sensitivity = 0.05;
  EXPECT_NEAR((recorded(x, t, 0.01, tilted, random) - x).maxCoeff(), 0.05, 1e-12);
  EXPECT_THROW((void)recorded(x, t.head(3), 0.01, tilted, random), std::invalid_argument);
}

}  // namespace
}  // namespace rigfit::ident::virtual_bending_test
