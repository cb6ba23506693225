#include "signal/recording/clipping.h"

#include "tests/test.h"

namespace rigfit::signal::clipping_test {

VectorXd sine(double period, double step) {
  return VectorXd::NullaryExpr(2000, [=](Index n) {
    const double x = std::sin(2 * EIGEN_PI * (static_cast<double>(n) + 0.3) / period);
    return step > 0 ? step * std::round(x / step) : x;
  });
}

bool clipped(const VectorXd& x, double range = 0) { return clipped_samples(x, range).count > 0; }

TEST(Clipping, FlatTopsAreNotQuantisation) {
  for (const double period : {8.0, 40.0, 300.0}) {
    for (const double step : {0.0, 1.0 / 2048, 1.0 / 32}) {
      const VectorXd x = sine(period, step);
      EXPECT_FALSE(clipped(x)) << period << " " << step;
      // Clipped to 60 %, on a level of the converter, with more than three samples above.
      const double level = step > 0 ? step * std::round(0.6 / step) : 0.6;
      if (period > 10) {
        EXPECT_TRUE(clipped(x.cwiseMin(level))) << period << " " << step;
        EXPECT_TRUE(clipped(x.cwiseMax(-level))) << period << " " << step;
      }
    }
  }
}

TEST(Clipping, RangeRestAndNothing) {
  const VectorXd x = sine(40, 0);
  EXPECT_TRUE(clipped(x, 0.99));
  EXPECT_FALSE(clipped(x, 1.01));
  VectorXd pulse = VectorXd::Zero(100);
  pulse.segment(40, 5) << 0.3, 0.8, 1, 0.7, 0.2;
  EXPECT_FALSE(clipped(pulse));  // at rest at its lower extreme
  EXPECT_FALSE(clipped(VectorXd::Constant(50, 3)));
  EXPECT_FALSE(clipped(VectorXd::Constant(50, kNaN)));
}

TEST(Clipping, RestAtAnEndAndValuesThatAreRepeatedAreNone) {
  VectorXd ramp = VectorXd::Zero(200);  // a machine's travel, at rest before it moves
  ramp.tail(160).setLinSpaced(0.5, 80);
  EXPECT_FALSE(clipped(ramp));
  EXPECT_FALSE(clipped(ramp.reverse()));
  VectorXd held(2000);  // a sensor read five times as often as it measures
  for (Index k = 0; k < held.size(); ++k) {
    held[k] = std::sin(0.03 * static_cast<double>(k - k % 5));
  }
  EXPECT_FALSE(clipped(held));
  EXPECT_TRUE(clipped(held.cwiseMin(0.6)));
}

TEST(Clipping, TwoEqualSamplesOfASharpTop) {
  // A half sine of six samples has two above 0.8; noise of five steps keeps tops unequal.
  VectorXd pulse = VectorXd::Zero(60);
  for (Index k = 0; k < 6; ++k)
    pulse[20 + k] = std::sin(EIGEN_PI * (static_cast<double>(k) + 0.6) / 6.2);
  for (Index k = 0; k < 60; ++k) pulse[k] += 1e-4 * std::sin(static_cast<double>(k * k));
  EXPECT_FALSE(clipped(pulse));
  EXPECT_TRUE(clipped(pulse.cwiseMin(0.8)));
}

}  // namespace rigfit::signal::clipping_test
