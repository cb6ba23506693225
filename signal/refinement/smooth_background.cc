#include "signal/refinement/smooth_background.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <complex>
#include <numbers>

namespace rigfit::signal {

Eigen::MatrixXcd smooth_background(const Eigen::Ref<const Eigen::VectorXcd>& s, int power,
                                   double span_s) {
  using Complex = std::complex<double>;
  using Eigen::Index;
  using Eigen::MatrixXcd;
  const Index lines = s.size();
  if (!(span_s > 0) || lines < 2) return {};
  constexpr double kPart = 1e-3;
  const double low = s[0].imag(), high = s[lines - 1].imag();
  const double product = 2 * span_s * (high - low) / (2 * std::numbers::pi);
  if (4 * (product + 4) > static_cast<double>(lines)) return {};
  // Delays closer than half of what the band resolves, so that any in between is spanned as well.
  const Index delays = 2 * static_cast<Index>(std::ceil(product)) + 9;
  MatrixXcd columns(lines, delays);
  for (Index j = 0; j < delays; ++j) {
    const double t = span_s * (2 * static_cast<double>(j) / static_cast<double>(delays - 1) - 1);
    columns.col(j) = (Complex(0, -t) * s.imag().array()).exp();
  }
  MatrixXcd residuals(lines, 2);
  residuals.col(0) = s.array().pow(power - 2);
  residuals.col(1) = s.array().pow(power);
  residuals.colwise().normalize();
  const Eigen::HouseholderQR<MatrixXcd> qr(residuals);
  const MatrixXcd known = qr.householderQ() * MatrixXcd::Identity(lines, 2);
  const double size = std::sqrt(static_cast<double>(lines * delays));
  columns -= (known * (known.adjoint() * columns)).eval();
  const Eigen::BDCSVD<MatrixXcd> svd(columns, Eigen::ComputeThinU);
  const Index terms = (svd.singularValues().array() > kPart * size).count();
  return svd.matrixU().leftCols(terms);
}

}  // namespace rigfit::signal
