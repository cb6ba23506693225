#include "ident/bending/deming_line.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rigfit::ident::deming_line_test {
namespace {

// With errors in x as large as in y (in units of the slope) ordinary regression is biased by
// var(error) / var(x); Deming's line is not. Mean over many sets against its standard error.
TEST(DemingLine, ErrorsInBothChannelsDoNotBiasTheSlope) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const Eigen::Index n = 60;
  const Eigen::VectorXd truth = Eigen::VectorXd::LinSpaced(n, 0, 1);
  constexpr int kSets = 300;
  const double noise = 0.1;  // attenuation of the ordinary slope: 0.01 / (1/12 + 0.01) = 11 %
  double sum = 0, squares = 0;
  int covered = 0;
  for (int set = 0; set < kSets; ++set) {
    Eigen::VectorXd x(n), y(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      x[i] = truth[i] + noise * normal(random);
      y[i] = 3 * truth[i] + 3 * noise * normal(random);
    }
    const auto line = fit_deming_line(x, y, noise, 3 * noise);
    sum += line.slope;
    squares += line.slope * line.slope;
    covered += std::abs(line.slope - 3) < 2.2 * line.slope_std;
  }
  const double mean = sum / kSets, std = std::sqrt(squares / kSets - mean * mean);
  EXPECT_NEAR(mean, 3, 4 * std / std::sqrt(kSets) + 0.02 * std);
  EXPECT_GT(covered,
            0.9 * kSets);  // sets are taken in rising x: the jackknife's blocks are ends too
}

TEST(DemingLine, OutliersHardlyMoveIt) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(100, 0, 1);
  Eigen::VectorXd y = x;
  for (Eigen::Index i = 0; i < 100; ++i) y[i] += 0.01 * normal(random);
  const double clean = fit_deming_line(x, y, 0, 0.01).slope;
  for (Eigen::Index i = 90; i < 100; i += 2) y[i] += 2;  // would tilt least squares by 0.5
  // Huber's influence of one point is 1.345 sigma at most: five near x = 0.95, sigma 0.01, the
  // others' sum of squares 7.3: 5 * 1.345 * 0.01 * 0.45 / 7.3 = 0.0041; and the five noises they
  // replace, three standard deviations: 3 * sqrt(5) * 0.01 * 0.45 / 7.3 = 0.0041.
  EXPECT_NEAR(fit_deming_line(x, y, 0, 0.01).slope, clean, 0.0082);
}

TEST(DemingLine, CurvatureIsTheRelativeChangeOfSlope) {
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(50, 0, 2);
  const Eigen::VectorXd y = (x.array() + 0.05 * x.array().square()).matrix();  // slope 1 to 1.2
  EXPECT_NEAR(fit_deming_line(x, y, 0, 0.01).curvature, 0.2 / 1.1, 1e-3);
}

TEST(DemingLine, TooLittleIsNotUsable) {
  EXPECT_FALSE(fit_deming_line(Eigen::Vector3d(0, 1, 2), Eigen::Vector3d(0, 1, 2), 0, 1).usable);
  EXPECT_FALSE(fit_deming_line(Eigen::Vector4d::Ones(), Eigen::Vector4d(0, 1, 2, 3), 0, 1).usable);
}

}  // namespace
}  // namespace rigfit::ident::deming_line_test
