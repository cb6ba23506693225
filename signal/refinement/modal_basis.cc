#include "signal/refinement/modal_basis.h"

#include <complex>
#include <numbers>

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

Eigen::ArrayXcd power_of(const Eigen::Ref<const Eigen::VectorXcd>& s, int power) {
  Eigen::ArrayXcd result = Eigen::ArrayXcd::Ones(s.size());
  for (int k = 0; k < power; ++k) result *= s.array();
  return result;
}

/// Columns 2r and 2r + 1: f + g and i (f - g), f = s^power / (s - p)^k, g = s^power / (s - conj
/// p)^k.
void fill_pole_columns(const Eigen::Ref<const Eigen::VectorXcd>& s, int power, int k,
                       const Eigen::Ref<const Eigen::VectorXcd>& poles, Eigen::MatrixXcd& columns) {
  const Eigen::ArrayXcd scale = power_of(s, power);
  for (Index r = 0; r < poles.size(); ++r) {
    Eigen::ArrayXcd f = (s.array() - poles[r]).inverse();
    Eigen::ArrayXcd g = (s.array() - std::conj(poles[r])).inverse();
    if (k == 2) f *= f, g *= g;
    columns.col(2 * r) = scale * (f + g);
    columns.col(2 * r + 1) = Complex(0, 1) * scale * (f - g);
  }
}

}  // namespace

int power_of_s(FrfForm form) { return form == FrfForm::unknown ? 0 : static_cast<int>(form); }

Eigen::VectorXcd laplace_lines(const Eigen::Ref<const Eigen::VectorXd>& frequency_hz,
                               double decay_rate_1_s) {
  Eigen::VectorXcd s(frequency_hz.size());
  s.real().setConstant(decay_rate_1_s);
  s.imag() = 2 * std::numbers::pi * frequency_hz;
  return s;
}

Eigen::MatrixXd stacked_basis(const Eigen::Ref<const Eigen::VectorXcd>& s, int power,
                              const Eigen::Ref<const Eigen::VectorXcd>& poles,
                              const Eigen::Ref<const Eigen::VectorXd>& line_weight) {
  Eigen::MatrixXcd columns(s.size(), 2 * poles.size() + 4);
  fill_pole_columns(s, power, 1, poles, columns);
  const Index lower = 2 * poles.size(), upper = lower + 2;
  columns.col(upper) = power_of(s, power);
  columns.col(lower) = columns.col(upper).array() / s.array().square();
  for (const Index at : {lower, upper}) columns.col(at + 1) = Complex(0, 1) * columns.col(at);
  return stacked(columns, line_weight);
}

Eigen::MatrixXd stacked_pole_derivatives(const Eigen::Ref<const Eigen::VectorXcd>& s, int power,
                                         const Eigen::Ref<const Eigen::VectorXcd>& poles,
                                         const Eigen::Ref<const Eigen::VectorXd>& line_weight) {
  Eigen::MatrixXcd columns(s.size(), 2 * poles.size());
  fill_pole_columns(s, power, 2, poles, columns);
  return stacked(columns, line_weight);
}

Eigen::MatrixXd stacked(const Eigen::Ref<const Eigen::MatrixXcd>& columns,
                        const Eigen::Ref<const Eigen::VectorXd>& line_weight) {
  Eigen::MatrixXd result(2 * columns.rows(), columns.cols());
  result << line_weight.asDiagonal() * columns.real(), line_weight.asDiagonal() * columns.imag();
  return result;
}

Eigen::MatrixXd summed_turns(const Eigen::Ref<const Eigen::MatrixXd>& A,
                             const Eigen::Ref<const Eigen::MatrixXcd>& residues,
                             const Eigen::Ref<const Eigen::VectorXd>& weight) {
  // A 2 x 2 block takes a complex z to alpha z + beta conj(z), a turn to residue z.
  const Eigen::MatrixXcd weighted = residues.conjugate() * weight.asDiagonal();
  const Eigen::MatrixXcd with = weighted * residues.transpose();
  const Eigen::MatrixXcd against = weighted * residues.adjoint();
  Eigen::MatrixXd sum(A.rows(), A.cols());
  for (Index q = 0; q < residues.rows(); ++q) {
    for (Index r = 0; r < residues.rows(); ++r) {
      const Eigen::Matrix2d B = 0.5 * A.block<2, 2>(2 * r, 2 * q);
      const Complex alpha = Complex(B(0, 0) + B(1, 1), B(1, 0) - B(0, 1)) * with(r, q);
      const Complex beta = Complex(B(0, 0) - B(1, 1), B(1, 0) + B(0, 1)) * against(r, q);
      const Complex one = alpha + beta, other = alpha - beta;
      sum.block<2, 2>(2 * r, 2 * q) << one.real(), -other.imag(), one.imag(), other.real();
    }
  }
  return sum;
}

Eigen::MatrixXcd synthesise(const Eigen::Ref<const Eigen::VectorXcd>& s, int power,
                            const Eigen::Ref<const Eigen::VectorXcd>& poles,
                            const Eigen::Ref<const Eigen::MatrixXcd>& residues,
                            const Eigen::Ref<const Eigen::VectorXcd>& lower,
                            const Eigen::Ref<const Eigen::VectorXcd>& upper) {
  Eigen::MatrixXcd all(residues.rows() + 2, residues.cols());
  all << residues, lower.transpose(), upper.transpose();
  const Eigen::Map<const Eigen::MatrixXd> coefficients(reinterpret_cast<const double*>(all.data()),
                                                       2 * all.rows(), all.cols());
  const Eigen::MatrixXd values =
      stacked_basis(s, power, poles, Eigen::VectorXd::Ones(s.size())) * coefficients;
  return values.topRows(s.size()) + Complex(0, 1) * values.bottomRows(s.size());
}

}  // namespace rigfit::signal
