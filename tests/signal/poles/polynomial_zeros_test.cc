#include "signal/poles/polynomial_zeros.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <complex>

namespace rigfit::signal::polynomial_zeros_test {
namespace {
using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;

/// Distance of each wanted value to the nearest found.
double farthest(const std::vector<Complex>& wanted, const Eigen::VectorXcd& found) {
  double worst = 0;
  for (const Complex w : wanted) worst = std::max(worst, (found.array() - w).abs().minCoeff());
  return worst;
}

TEST(PolynomialZeros, OfAProductOfFactors) {
  // (1 - y1 z)(1 - y2 z)(1 - y2* z): zeros at 1 / y.
  const Complex y2(0.3, 0.9);
  const double y1 = -1.5;
  MatrixXd A(3, 1);
  const double s = -2 * y2.real(), p = std::norm(y2);
  A << -y1 + s, -y1 * s + p, -y1 * p;
  const auto found = reciprocal_zeros(A, 1);
  ASSERT_EQ(found.size(), 3);
  EXPECT_LT(farthest({y1, y2, std::conj(y2)}, found), 1e-14);
}

TEST(PolynomialZeros, OfBlocksMakeTheDeterminantVanish) {
  // I + A1 z + ... + A4 z^4 of 3 x 3: 12 zeros, each with a determinant at rounding.
  const Index size = 3, order = 4;
  const MatrixXd A = MatrixXd::Random(size * order, size);
  const auto found = reciprocal_zeros(A, size);
  ASSERT_EQ(found.size(), size * order);
  for (const Complex y : found) {
    // y^n det(I + ...) with z = 1 / y, so that nothing overflows.
    Eigen::Matrix3cd P = Eigen::Matrix3cd::Identity() * std::pow(y, 4);
    for (Index k = 1; k <= order; ++k) {
      P += A.middleRows((k - 1) * size, size).cast<Complex>() *
           std::pow(y, static_cast<double>(order - k));
    }
    const Complex determinant = P(0, 0) * (P(1, 1) * P(2, 2) - P(1, 2) * P(2, 1)) -
                                P(0, 1) * (P(1, 0) * P(2, 2) - P(1, 2) * P(2, 0)) +
                                P(0, 2) * (P(1, 0) * P(2, 1) - P(1, 1) * P(2, 0));
    EXPECT_LT(std::abs(determinant), 1e-11 * std::pow(std::max(1.0, P.cwiseAbs().maxCoeff()), 3));
  }
}

}  // namespace
}  // namespace rigfit::signal::polynomial_zeros_test
