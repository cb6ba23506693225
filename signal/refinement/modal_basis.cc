#include "signal/refinement/modal_basis.h"

namespace rigfit::signal {
namespace {

ArrayXcd power_of(const Ref<const VectorXcd>& s, int power) {
  ArrayXcd result = ArrayXcd::Ones(s.size());
  for (int k = 0; k < power; ++k) result *= s.array();
  return result;
}

/// Columns 2r and 2r + 1: f + g and i (f - g), f = s^power / (s - p)^k, g = s^power / (s - conj
/// p)^k.
void fill_pole_columns(const Ref<const VectorXcd>& s, int power, int k,
                       const Ref<const VectorXcd>& poles, MatrixXcd& columns) {
  const ArrayXcd scale = power_of(s, power);
  for (Index r = 0; r < poles.size(); ++r) {
    ArrayXcd f = (s.array() - poles[r]).inverse();
    ArrayXcd g = (s.array() - std::conj(poles[r])).inverse();
    if (k == 2) f *= f, g *= g;
    columns.col(2 * r) = scale * (f + g);
    columns.col(2 * r + 1) = Complex(0, 1) * scale * (f - g);
  }
}

}  // namespace

int power_of_s(FrfForm form) { return form == FrfForm::unknown ? 0 : static_cast<int>(form); }

VectorXcd laplace_lines(const Ref<const VectorXd>& frequency_hz, double decay_rate_1_s) {
  VectorXcd s(frequency_hz.size());
  s.real().setConstant(decay_rate_1_s);
  s.imag() = 2 * std::numbers::pi * frequency_hz;
  return s;
}

MatrixXd stacked_basis(const Ref<const VectorXcd>& s, int power, const Ref<const VectorXcd>& poles,
                       const Ref<const VectorXd>& line_weight,
                       const Ref<const MatrixXcd>& background) {
  MatrixXcd columns(s.size(), 2 * poles.size() + 4 + 2 * background.cols());
  fill_pole_columns(s, power, 1, poles, columns);
  auto add = [&, at = 2 * poles.size()](const auto& column) mutable {
    columns.col(at).array() = column;
    columns.col(at + 1) = Complex(0, 1) * columns.col(at);
    at += 2;
  };
  const ArrayXcd upper = power_of(s, power);
  add(upper / s.array().square());
  add(upper);
  for (const auto& term : background.colwise()) add(term.array());
  return stacked(columns, line_weight);
}

MatrixXd stacked_pole_derivatives(const Ref<const VectorXcd>& s, int power,
                                  const Ref<const VectorXcd>& poles,
                                  const Ref<const VectorXd>& line_weight) {
  MatrixXcd columns(s.size(), 2 * poles.size());
  fill_pole_columns(s, power, 2, poles, columns);
  return stacked(columns, line_weight);
}

MatrixXd stacked(const Ref<const MatrixXcd>& columns, const Ref<const VectorXd>& line_weight) {
  MatrixXd result(2 * columns.rows(), columns.cols());
  result << line_weight.asDiagonal() * columns.real(), line_weight.asDiagonal() * columns.imag();
  return result;
}

MatrixXd summed_turns(const Ref<const MatrixXd>& A, const Ref<const MatrixXcd>& residues,
                      const Ref<const VectorXd>& weight) {
  // A 2 x 2 block takes a complex z to alpha z + beta conj(z), a turn to residue z.
  const MatrixXcd weighted = residues.conjugate() * weight.asDiagonal();
  const MatrixXcd with = weighted * residues.transpose();
  const MatrixXcd against = weighted * residues.adjoint();
  MatrixXd sum(A.rows(), A.cols());
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

MatrixXcd synthesise(const Ref<const VectorXcd>& s, int power, const Ref<const VectorXcd>& poles,
                     const Ref<const MatrixXcd>& residues, const Ref<const VectorXcd>& lower,
                     const Ref<const VectorXcd>& upper) {
  MatrixXcd all(residues.rows() + 2, residues.cols());
  all << residues, lower.transpose(), upper.transpose();
  const Map<const MatrixXd> coefficients(reinterpret_cast<const double*>(all.data()),
                                         2 * all.rows(), all.cols());
  const MatrixXd values = stacked_basis(s, power, poles, VectorXd::Ones(s.size())) * coefficients;
  return values.topRows(s.size()) + Complex(0, 1) * values.bottomRows(s.size());
}

}  // namespace rigfit::signal
