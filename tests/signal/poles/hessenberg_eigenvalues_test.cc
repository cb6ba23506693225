#include "signal/poles/hessenberg_eigenvalues.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <complex>
#include <cstdint>
#include <numbers>
#include <random>

namespace rigfit::signal::hessenberg_eigenvalues_test {
namespace {
using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd random_hessenberg(Index size) {
  std::mt19937_64 random(static_cast<std::uint64_t>(size));
  std::normal_distribution<double> normal;
  MatrixXd H = MatrixXd::NullaryExpr(size, size, [&] { return normal(random); });
  for (Index j = 0; j < size; ++j) H.col(j).tail(std::max<Index>(0, size - j - 2)).setZero();
  return H;
}

// The arithmetic is Eigen's, so that only products which a compiler fuses may differ: rounding of a
// matrix of norm 3 at most, times the condition of its eigenvalues, 1e3 for these sizes.
TEST(HessenbergEigenvalues, AreThoseOfEigen) {
  for (const Index size : {1, 2, 3, 4, 7, 20, 60, 150}) {
    const MatrixXd H = random_hessenberg(size) / std::sqrt(static_cast<double>(size));
    const auto found = hessenberg_eigenvalues(H);
    const Eigen::VectorXcd wanted = Eigen::EigenSolver<MatrixXd>(H, false).eigenvalues();
    ASSERT_EQ(found.size(), size);
    for (const auto value : wanted) EXPECT_LT((found.array() - value).abs().minCoeff(), 1e-11);
    EXPECT_LT(std::abs(found.sum() - H.trace()), 1e-14 * static_cast<double>(size));
  }
}

// The eigenvalues of a cyclic shift lie on a circle, so that no shift of the first steps separates
// them: they come from the exceptional one. Of a nilpotent matrix all are 0.
TEST(HessenbergEigenvalues, OfACyclicShiftAndOfANilpotentMatrix) {
  MatrixXd shift = MatrixXd::Zero(8, 8);
  shift.bottomLeftCorner(7, 7).setIdentity();
  EXPECT_EQ(hessenberg_eigenvalues(shift), Eigen::VectorXcd::Zero(8));
  shift(0, 7) = 1;
  const auto found = hessenberg_eigenvalues(shift);
  ASSERT_EQ(found.size(), 8);
  for (int k = 0; k < 8; ++k) {
    const auto wanted = std::polar(1.0, k * std::numbers::pi / 4);
    EXPECT_LT((found.array() - wanted).abs().minCoeff(), 1e-14);
  }
}

TEST(HessenbergEigenvalues, OfBlocksThatHaveSplitOff) {
  MatrixXd H = random_hessenberg(30);
  for (const Index k : {5, 6, 14, 22}) H(k, k - 1) = 0;
  const auto found = hessenberg_eigenvalues(H);
  for (const auto& [first, last] : {std::pair{0, 5}, {5, 6}, {6, 14}, {14, 22}, {22, 30}}) {
    const auto part =
        hessenberg_eigenvalues(H.block(first, first, last - first, last - first).eval());
    EXPECT_LT((found.segment(first, last - first) - part).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(HessenbergEigenvalues, NoneOfWhatIsNotFinite) {
  MatrixXd H = random_hessenberg(5);
  H(2, 3) = std::nan("");
  EXPECT_EQ(hessenberg_eigenvalues(H).size(), 0);
}

}  // namespace
}  // namespace rigfit::signal::hessenberg_eigenvalues_test
