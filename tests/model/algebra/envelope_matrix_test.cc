#include "model/algebra/envelope_matrix.h"

#include <Eigen/Dense>
#include <random>

#include "tests/expect_matrix.h"
#include "tests/reference/dense_eigen.h"

namespace rigfit::model::envelope_matrix_test {
namespace {

using rigfit::testing::MatricesNear;

template <class Scalar>
EnvelopeMatrixOf<Scalar> random_matrix(int n, std::mt19937_64& random) {
  std::vector<int> first;
  for (int i = 0; i < n; ++i) {
    first.push_back(std::max(0, i - std::uniform_int_distribution<int>(0, 9)(random)));
  }
  EnvelopeMatrixOf<Scalar> matrix(Envelope::from_rows(first));
  std::normal_distribution<double> normal;
  for (int i = 0; i < n; ++i) {
    for (int j = first[std::size_t(i)]; j <= i; ++j) {
      if constexpr (std::is_same_v<Scalar, double>) {
        matrix.add(i, j, normal(random));
      } else {
        matrix.add(i, j, Scalar(normal(random), normal(random)));
      }
    }
    matrix.add(i, i, 2 * normal(random));
  }
  return matrix;
}

TEST(EnvelopeFactor, SolvesAndCountsAsDenseAlgebraDoes) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const auto matrix = random_matrix<double>(40, random);
    const Eigen::MatrixXd dense = matrix.dense();
    const Eigen::VectorXd x = Eigen::VectorXd::Random(40);
    Eigen::VectorXd y = matrix * x;
    EXPECT_TRUE(MatricesNear(y, dense * x, 1e-12));
    EnvelopeFactor factor;
    ASSERT_TRUE(factor.factor(matrix));
    factor.solve_in_place(y);
    // No pivoting: the error grows with the inverse of the smallest pivot met.
    EXPECT_TRUE(MatricesNear(y, x, 1e-10 / factor.smallest_pivot_ratio()));
    EXPECT_EQ(factor.negative_pivots(),
              (testing::symmetric_eigenvalues(dense).array() < 0).count());
  }
}

// Zeros that rows begin with go, those inside stay: the same matrix, and the same products.
TEST(EnvelopeMatrix, TrimmedIsTheSameMatrix) {
  EnvelopeMatrix matrix(Envelope::from_rows({0, 0, 0, 1, 0}));
  matrix.add(0, 0, 1), matrix.add(1, 1, 2), matrix.add(2, 2, 3);
  matrix.add(3, 3, 4), matrix.add(4, 4, 5);
  matrix.add(2, 1, 6), matrix.add(3, 1, 7), matrix.add(4, 2, 8);
  const EnvelopeMatrix trimmed = matrix.trimmed();
  EXPECT_EQ(trimmed.envelope()->first, (std::vector<int>{0, 1, 1, 1, 2}));
  EXPECT_TRUE(MatricesNear(trimmed.dense(), matrix.dense(), 0));
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(5, -1, 2);
  EXPECT_TRUE(MatricesNear(trimmed * x, matrix * x, 0));
}

TEST(EnvelopeFactor, SolvesComplexSymmetricMatrices) {
  std::mt19937_64 random(2);
  const auto matrix = random_matrix<std::complex<double>>(30, random);
  const Eigen::VectorXcd x = Eigen::VectorXcd::Random(30);
  Eigen::VectorXcd y = matrix * x;
  EXPECT_TRUE(MatricesNear((y - matrix.dense() * x).cwiseAbs(), Eigen::VectorXd::Zero(30), 1e-12));
  ComplexEnvelopeFactor factor;
  ASSERT_TRUE(factor.factor(matrix));
  factor.solve_in_place(y);
  EXPECT_LT((y - x).norm(), 1e-10 / factor.smallest_pivot_ratio());
}

TEST(EnvelopeFactor, NamesTheRowOfASingularPivot) {
  EnvelopeMatrix matrix(Envelope::from_rows({0, 0, 1}));
  matrix.add(0, 0, 1);
  matrix.add(1, 0, 1);
  matrix.add(1, 1, 1);
  matrix.add(2, 2, 3);
  EnvelopeFactor factor;
  EXPECT_FALSE(factor.factor(matrix));
  EXPECT_EQ(factor.smallest_pivot_row(), 1);
}

}  // namespace
}  // namespace rigfit::model::envelope_matrix_test
