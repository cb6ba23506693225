#include "model/algebra/envelope_matrix.h"

#include <cassert>

namespace rigfit::model {
namespace {

/// sum x_k y_k without conjugation (complex symmetric, not Hermitian).
template <class Scalar>
inline Scalar dot(const Scalar* x, const Scalar* y, int n) {
  Scalar s0 = 0, s1 = 0;
  int k = 0;
  for (; k + 1 < n; k += 2) {
    s0 += x[k] * y[k];
    s1 += x[k + 1] * y[k + 1];
  }
  if (k < n) s0 += x[k] * y[k];
  return s0 + s1;
}

inline double real_part(double x) { return x; }
inline double real_part(const Complex& x) { return x.real(); }

}  // namespace

std::shared_ptr<const Envelope> Envelope::from_rows(std::vector<int> first) {
  auto envelope = std::make_shared<Envelope>();
  envelope->size = static_cast<int>(first.size());
  envelope->offset.resize(first.size());
  long entries = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    assert(first[i] >= 0 && first[i] <= static_cast<int>(i));
    envelope->offset[i] = entries - first[i];
    entries += static_cast<long>(i) - first[i] + 1;
  }
  envelope->entries = entries;
  envelope->first = std::move(first);
  return envelope;
}

template <class Scalar>
EnvelopeMatrixOf<Scalar>::EnvelopeMatrixOf(std::shared_ptr<const Envelope> envelope)
    : envelope_(std::move(envelope)), values_(Vector::Zero(envelope_->entries)) {}

template <class Scalar>
Scalar EnvelopeMatrixOf<Scalar>::at(int i, int j) const {
  if (i < j) std::swap(i, j);
  const auto row = static_cast<std::size_t>(i);
  return j < envelope_->first[row] ? Scalar(0) : values_[envelope_->offset[row] + j];
}

template <class Scalar>
void EnvelopeMatrixOf<Scalar>::multiply(const Vector& x, Vector& y) const {
  y.setZero(size());
  for (int i = 0; i < size(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    const Scalar* a = values_.data() + envelope_->offset[row];
    Scalar sum = a[i] * x[i];
    const Scalar xi = x[i];
    for (int j = envelope_->first[row]; j < i; ++j) {
      sum += a[j] * x[j];
      y[j] += a[j] * xi;
    }
    y[i] += sum;
  }
}

template <class Scalar>
typename EnvelopeMatrixOf<Scalar>::Vector EnvelopeMatrixOf<Scalar>::operator*(
    const Vector& x) const {
  Vector y;
  multiply(x, y);
  return y;
}

template <class Scalar>
typename EnvelopeMatrixOf<Scalar>::Matrix EnvelopeMatrixOf<Scalar>::operator*(
    const Matrix& x) const {
  Matrix y(x.rows(), x.cols());
  for (Index c = 0; c < x.cols(); ++c) y.col(c) = *this * Vector(x.col(c));
  return y;
}

VectorXcd operator*(const EnvelopeMatrix& a, const VectorXcd& u) {
  VectorXcd out(u.size());
  out.real() = a * VectorXd(u.real());
  out.imag() = a * VectorXd(u.imag());
  return out;
}

template <class Scalar>
Eigen::SparseMatrix<Scalar> EnvelopeMatrixOf<Scalar>::sparse() const {
  std::vector<Eigen::Triplet<Scalar>> entries;
  for (int i = 0; i < size(); ++i) {
    for (int j = envelope_->first[static_cast<std::size_t>(i)]; j <= i; ++j) {
      const Scalar value = at(i, j);
      if (value == Scalar(0)) continue;
      entries.emplace_back(i, j, value);
      if (j < i) entries.emplace_back(j, i, value);
    }
  }
  Eigen::SparseMatrix<Scalar> out(size(), size());
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

template <class Scalar>
bool EnvelopeFactorOf<Scalar>::factor(const EnvelopeMatrixOf<Scalar>& matrix, double singular) {
  factors_ = matrix;
  const Envelope& envelope = *factors_.envelope();
  const int n = envelope.size;
  pivot_.resize(n);
  inverse_pivot_.resize(n);
  negative_ = 0;
  smallest_ratio_ = n > 0 ? std::numeric_limits<double>::infinity() : 1;
  smallest_row_ = -1;
  bool regular = true;
  Scalar* values = factors_.values().data();
  for (int i = 0; i < n; ++i) {
    const auto row = static_cast<std::size_t>(i);
    Scalar* a = values + envelope.offset[row];
    const int begin = envelope.first[row];
    // Row i of L D (unscaled), then of L.
    for (int j = begin + 1; j < i; ++j) {
      const int from = std::max(begin, envelope.first[static_cast<std::size_t>(j)]);
      const Scalar* l = values + envelope.offset[static_cast<std::size_t>(j)];
      a[j] -= dot(a + from, l + from, j - from);
    }
    const Scalar diagonal = a[i];
    Scalar pivot = diagonal;
    double scale = std::abs(diagonal);
    for (int j = begin; j < i; ++j) {
      const Scalar u = a[j];
      a[j] = u * inverse_pivot_[j];
      pivot -= u * a[j];
      scale = std::max(scale, std::abs(u * a[j]));
    }
    const double ratio = scale > 0 ? std::abs(pivot) / scale : 0;
    if (ratio < smallest_ratio_) smallest_ratio_ = ratio, smallest_row_ = i;
    if (!(ratio > singular)) {
      regular = false;
      const double size = std::max(singular * scale, 1e-300);
      pivot = real_part(pivot) < 0 ? Scalar(-size) : Scalar(size);
    }
    if (real_part(pivot) < 0) ++negative_;
    pivot_[i] = pivot;
    inverse_pivot_[i] = Scalar(1) / pivot;
  }
  return regular;
}

template <class Scalar>
void EnvelopeFactorOf<Scalar>::solve_in_place(Scalar* x) const {
  const Envelope& envelope = *factors_.envelope();
  const Scalar* values = factors_.values().data();
  const int n = envelope.size;
  int start = 0;  // zeros above the first entry stay
  while (start < n && x[start] == Scalar(0)) ++start;
  for (int i = start + 1; i < n; ++i) {
    const auto row = static_cast<std::size_t>(i);
    const int begin = envelope.first[row];
    if (begin == i) continue;
    // The entry before last of all: only it waits for the row before.
    const Scalar* l = values + envelope.offset[row];
    x[i] = (x[i] - dot(l + begin, x + begin, i - 1 - begin)) - l[i - 1] * x[i - 1];
  }
  for (int i = start; i < n; ++i) x[i] *= inverse_pivot_[i];
  for (int i = n - 1; i > 0; --i) {
    const auto row = static_cast<std::size_t>(i);
    const Scalar* l = values + envelope.offset[row];
    const Scalar xi = x[i];
    for (int j = envelope.first[row]; j < i; ++j) x[j] -= l[j] * xi;
  }
}

template class EnvelopeMatrixOf<double>;
template class EnvelopeMatrixOf<Complex>;
template class EnvelopeFactorOf<double>;
template class EnvelopeFactorOf<Complex>;

}  // namespace rigfit::model
