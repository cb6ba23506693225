#include "signal/window.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace rigfit::signal {
namespace {

TEST(Window, ExponentialFallsToTheLevelItWasMadeFor) {
  const double rate = decay_rate_for(0.01, 2.0);
  EXPECT_DOUBLE_EQ(rate, std::log(100.0) / 2);
  const Eigen::VectorXd w = exponential_window(2001, 1000, rate);
  EXPECT_EQ(w[0], 1);
  EXPECT_NEAR(w[2000], 0.01, 1e-14);
  EXPECT_THROW((void)decay_rate_for(0, 1), std::invalid_argument);
  EXPECT_THROW((void)decay_rate_for(1.5, 1), std::invalid_argument);
}

TEST(Window, ForceIsKeptThenFadedThenGone) {
  const Eigen::VectorXd w = force_window(20, 5, 3);
  EXPECT_EQ(w.head(5), Eigen::VectorXd::Ones(5));
  EXPECT_NEAR(w[6], 0.5, 1e-15);  // the middle of a half cosine
  EXPECT_GT(w[5], w[6]);
  EXPECT_GT(w[7], 0);
  EXPECT_EQ(w.tail(12), Eigen::VectorXd::Zero(12));
}

}  // namespace
}  // namespace rigfit::signal
