#include "signal/refinement/smooth_background.h"

#include <cmath>
#include <complex>
#include <numbers>

#include "signal/numerics/factorisations.h"

namespace rigfit::signal {

namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;

/// Orthonormal columns s^power, s^(power - 2) and, with `middle`, s^(power - 1).
MatrixXcd powers_of_s(const VectorXcd& s, int power, bool middle) {
  MatrixXcd columns(s.size(), middle ? 3 : 2);
  columns.col(0) = s.array().pow(power - 2);
  columns.col(1) = s.array().pow(power);
  if (middle) columns.col(2) = s.array().pow(power - 1);
  columns.colwise().normalize();
  return thin_qr(columns).Q;
}

/// What exp(-i w t), `first` <= t <= `last`, span outside of `known`.
MatrixXcd terms_between(const VectorXcd& s, const MatrixXcd& known, double first, double last) {
  const Index lines = s.size();
  if (!(last > first) || lines < 2) return MatrixXcd(lines, 0);
  constexpr double kPart = 1e-3;
  const double low = s[0].imag(), high = s[lines - 1].imag();
  const double product = (last - first) * (high - low) / (2 * std::numbers::pi);
  if (4 * (product + 4) > static_cast<double>(lines)) return MatrixXcd(lines, 0);
  // Delays closer than half of what the band resolves, so that any in between is spanned as well.
  const Index delays = 2 * static_cast<Index>(std::ceil(product)) + 9;
  MatrixXcd columns(lines, delays);
  for (Index j = 0; j < delays; ++j) {
    const double part = static_cast<double>(j) / static_cast<double>(delays - 1);
    const double t = first + (last - first) * part;
    columns.col(j) = (Complex(0, -t) * s.imag().array()).exp();
  }
  const double size = std::sqrt(static_cast<double>(lines * delays));
  columns -= (known * (known.adjoint() * columns)).eval();
  // Singular vectors above kPart by the Gram matrix: orthonormal to 1e-16 / kPart^2.
  const HermitianEigen gram = hermitian_eigen(columns.adjoint() * columns);
  const Eigen::ArrayXd squares = gram.values;
  const Index terms = (squares > kPart * kPart * size * size).count();
  return columns * gram.vectors.rightCols(terms) *
         gram.values.tail(terms).cwiseSqrt().cwiseInverse().asDiagonal();
}

}  // namespace

MatrixXcd smooth_background(const Eigen::Ref<const VectorXcd>& s, int power, double span_s) {
  if (!(span_s > 0) || s.size() < 2) return MatrixXcd(s.size(), 0);
  return terms_between(s, powers_of_s(s, power, false), -span_s, span_s);
}

MatrixXcd cut_off_background(const Eigen::Ref<const VectorXcd>& s, int power, double before_s,
                             double after_s) {
  if (s.size() < 3) return MatrixXcd(s.size(), 0);
  const MatrixXcd known = powers_of_s(s, power, true);
  const MatrixXcd smooth = terms_between(s, known, -before_s, after_s);
  MatrixXcd terms(s.size(), 1 + smooth.cols());
  terms.col(0) = known.col(2);
  terms.rightCols(smooth.cols()) = smooth;
  return terms;
}

}  // namespace rigfit::signal
