#include "signal/poles/polynomial_zeros.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <complex>

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// Similarity by reflections (Golub, Van Loan, Matrix Computations, 4th ed., algorithm 7.4.2). The
/// first `size` columns of a block companion's lower part are the identity: only where a column has
/// something below the first subdiagonal is there anything to reflect.
void to_hessenberg(MatrixXd& A) {
  const Index n = A.rows();
  VectorXd v, row, column;
  for (Index k = 0; k + 2 < n; ++k) {
    const Index below = n - k - 1;
    v = A.col(k).tail(below);
    const double rest = v.tail(below - 1).squaredNorm();
    if (rest == 0) continue;
    const double length = std::sqrt(v[0] * v[0] + rest);
    const double image = v[0] > 0 ? -length : length;
    v[0] -= image;
    v /= std::sqrt(0.5 * (v[0] * v[0] + rest));  // H = I - v v'
    row = v.transpose() * A.bottomRightCorner(below, n - k);
    A.bottomRightCorner(below, n - k).noalias() -= v * row.transpose();
    column = A.rightCols(below) * v;
    A.rightCols(below).noalias() -= column * v.transpose();
    A(k + 1, k) = image;
    A.col(k).tail(below - 1).setZero();
  }
}

}  // namespace

VectorXcd reciprocal_zeros(const Eigen::Ref<const MatrixXd>& A, Index block_size) {
  const Index size = A.rows();
  MatrixXd companion = MatrixXd::Zero(size, size);
  for (Index block = 0; block < size / block_size; ++block) {
    companion.block(0, block * block_size, block_size, block_size) =
        -A.block(block * block_size, 0, block_size, block_size);
  }
  companion.bottomLeftCorner(size - block_size, size - block_size).setIdentity();
  Eigen::RealSchur<MatrixXd> schur(size);
  if (block_size > 1) to_hessenberg(companion);
  schur.computeFromHessenberg(companion, MatrixXd(), false);
  if (schur.info() != Eigen::Success) return {};
  const MatrixXd& T = schur.matrixT();
  VectorXcd y(size);
  for (Index i = 0; i < size;) {
    if (i + 1 < size && T(i + 1, i) != 0) {
      const double half = 0.5 * (T(i, i) - T(i + 1, i + 1));
      const double middle = 0.5 * (T(i, i) + T(i + 1, i + 1));
      const Complex root = std::sqrt(Complex(half * half + T(i, i + 1) * T(i + 1, i)));
      y[i] = middle + root;
      y[i + 1] = middle - root;
      i += 2;
    } else {
      y[i] = T(i, i);
      ++i;
    }
  }
  return y;
}

}  // namespace rigfit::signal
