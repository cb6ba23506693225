#include "signal/spectra/window.h"

#include "tests/test.h"

namespace rigfit::signal::window_test {

TEST(Window, ExponentialFallsToTheLevelItWasMadeFor) {
  const double rate = decay_rate_for(0.01, 2.0);
  EXPECT_DOUBLE_EQ(rate, std::log(100.0) / 2);
  const Eigen::VectorXd w = exponential_window(2001, 1000, rate);
  EXPECT_EQ(w[0], 1);
  EXPECT_NEAR(w[2000], 0.01, 1e-14);
  EXPECT_THROW((void)decay_rate_for(0, 1), std::invalid_argument);
  EXPECT_THROW((void)decay_rate_for(1.5, 1), std::invalid_argument);
}

TEST(Window, ForceIsKeptAndFadedOnBothSides) {
  const Eigen::VectorXd w = force_window(20, 6, 11, 3);
  EXPECT_EQ(w.segment(6, 5), Eigen::VectorXd::Ones(5));
  EXPECT_NEAR(w[12], 0.5, 1e-15);  // the middle of a half cosine
  EXPECT_GT(w[11], w[12]);
  EXPECT_GT(w[13], 0);
  EXPECT_EQ(w.tail(6), Eigen::VectorXd::Zero(6));
  EXPECT_NEAR(w[4], 0.5, 1e-15);
  EXPECT_EQ(w.head(3), Eigen::VectorXd::Zero(3));
  EXPECT_EQ(force_window(5, 0, 5, 2), Eigen::VectorXd::Ones(5));
}

}  // namespace rigfit::signal::window_test
