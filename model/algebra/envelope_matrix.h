// Symmetric sparse matrices in envelope (skyline) storage and their L D L' factors: what a chain of
// segments needs. Row i holds columns first[i]..i; the factor fills nothing outside of that.
//
// L D L' without pivoting of K - sigma M counts, by Sylvester's law of inertia, how many
// eigenvalues lie below sigma (its negative pivots): B. N. Parlett, The Symmetric Eigenvalue
// Problem, ch. 3. Complex symmetric matrices (K + i omega C) factor the same way, without a count.
#pragma once

#include <Eigen/SparseCore>

#include "model/algebra/numbers.h"

namespace rigfit::model {

/// Where the entries are: shared by all matrices of one numbering.
struct Envelope {
  std::vector<int> first;    ///< per row: its first column
  std::vector<long> offset;  ///< per row: entry (i, j) lies at offset[i] + j
  int size = 0;
  long entries = 0;

  /// From the first column of each row (first[i] <= i).
  [[nodiscard]] static std::shared_ptr<const Envelope> from_rows(std::vector<int> first);
};

template <class Scalar>
class EnvelopeMatrixOf {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  EnvelopeMatrixOf() = default;
  /// All zero.
  explicit EnvelopeMatrixOf(std::shared_ptr<const Envelope> envelope);

  [[nodiscard]] int size() const { return envelope_ ? envelope_->size : 0; }
  [[nodiscard]] const std::shared_ptr<const Envelope>& envelope() const { return envelope_; }
  void set_zero() { values_.setZero(); }
  /// Adds to entry (i, j) and, by symmetry, (j, i): name each off-diagonal pair once.
  void add(int i, int j, Scalar value) {
    if (i < j) std::swap(i, j);
    values_[envelope_->offset[static_cast<std::size_t>(i)] + j] += value;
  }
  [[nodiscard]] Scalar at(int i, int j) const;
  /// All stored entries, row by row: matrices of one envelope combine as `values()` do.
  [[nodiscard]] Vector& values() { return values_; }
  [[nodiscard]] const Vector& values() const { return values_; }
  /// y = A x, without allocation when y has its size.
  void multiply(const Vector& x, Vector& y) const;
  [[nodiscard]] Vector operator*(const Vector& x) const;
  [[nodiscard]] Matrix operator*(const Matrix& x) const;
  /// Without zeros: products cost less.
  [[nodiscard]] Eigen::SparseMatrix<Scalar> sparse() const;

 private:
  std::shared_ptr<const Envelope> envelope_;
  Vector values_;
};

/// A = L D L', in place in its own storage; refactoring allocates nothing.
template <class Scalar>
class EnvelopeFactorOf {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

  /// False when a pivot vanished (below `singular` times the diagonal it started from); it is
  /// then replaced by that bound, so that the factor can still be used near the singular matrix.
  bool factor(const EnvelopeMatrixOf<Scalar>& matrix, double singular = 1e-15);
  /// x = A^-1 x.
  void solve_in_place(Vector& x) const { solve_in_place(x.data()); }
  /// The same for each column.
  void solve_in_place(Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>& x) const {
    for (Index c = 0; c < x.cols(); ++c) solve_in_place(x.col(c).data());
  }
  [[nodiscard]] int negative_pivots() const { return negative_; }  ///< real matrices only
  /// Smallest |pivot| over the diagonal it started from, and its row.
  [[nodiscard]] double smallest_pivot_ratio() const { return smallest_ratio_; }
  [[nodiscard]] int smallest_pivot_row() const { return smallest_row_; }
  [[nodiscard]] int size() const { return factors_.size(); }

 private:
  void solve_in_place(Scalar* x) const;

  EnvelopeMatrixOf<Scalar> factors_;
  Vector pivot_;
  Vector inverse_pivot_;
  int negative_ = 0;
  double smallest_ratio_ = 0;
  int smallest_row_ = -1;
};

using EnvelopeMatrix = EnvelopeMatrixOf<double>;
using EnvelopeFactor = EnvelopeFactorOf<double>;
using ComplexEnvelopeMatrix = EnvelopeMatrixOf<Complex>;
using ComplexEnvelopeFactor = EnvelopeFactorOf<Complex>;

/// A u of a real matrix.
[[nodiscard]] VectorXcd operator*(const EnvelopeMatrix& a, const VectorXcd& u);

extern template class EnvelopeMatrixOf<double>;
extern template class EnvelopeMatrixOf<Complex>;
extern template class EnvelopeFactorOf<double>;
extern template class EnvelopeFactorOf<Complex>;

}  // namespace rigfit::model
