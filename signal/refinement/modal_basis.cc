#include "signal/refinement/modal_basis.h"

#include <complex>
#include <numbers>

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

Complex integer_power(Complex s, int power) {
  Complex result = 1;
  for (int i = 0; i < power; ++i) result *= s;
  for (int i = 0; i > power; --i) result /= s;
  return result;
}

/// Columns 2r and 2r + 1: f + g and i (f - g), f = scale / (s - p)^k, g = scale / (s - conj p)^k.
void fill_pole_columns(const Eigen::Ref<const Eigen::VectorXcd>& s, int power, int k,
                       const Eigen::Ref<const Eigen::VectorXcd>& poles,
                       const Eigen::Ref<const Eigen::VectorXd>& line_weight,
                       Eigen::Ref<Eigen::MatrixXd> basis) {
  const Index lines = s.size();
  const Eigen::VectorXcd scale = s.unaryExpr([&](Complex value) {
                                    return integer_power(value, power);
                                  }).cwiseProduct(line_weight.cast<Complex>());
  for (Index r = 0; r < poles.size(); ++r) {
    const Complex p = poles[r], q = std::conj(p);
    double* const re = &basis(0, 2 * r);
    double* const im = &basis(0, 2 * r + 1);
    for (Index i = 0; i < lines; ++i) {
      Complex f = 1.0 / (s[i] - p), g = 1.0 / (s[i] - q);
      if (k == 2) f *= f, g *= g;
      f *= scale[i], g *= scale[i];
      const Complex sum = f + g, difference = f - g;
      re[i] = sum.real();
      re[lines + i] = sum.imag();
      im[i] = -difference.imag();
      im[lines + i] = difference.real();
    }
  }
}

}  // namespace

int power_of_s(FrfForm form) {
  switch (form) {
    case FrfForm::mobility:
      return 1;
    case FrfForm::accelerance:
      return 2;
    default:
      return 0;
  }
}

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
  const Index lines = s.size(), modes = poles.size();
  Eigen::MatrixXd basis(2 * lines, 2 * modes + 4);
  fill_pole_columns(s, power, 1, poles, line_weight, basis.leftCols(2 * modes));
  for (int residual = 0; residual < 2; ++residual) {
    const Index column = 2 * modes + 2 * residual;
    for (Index i = 0; i < lines; ++i) {
      const Complex value = line_weight[i] * integer_power(s[i], residual == 0 ? power - 2 : power);
      basis(i, column) = value.real();
      basis(lines + i, column) = value.imag();
      basis(i, column + 1) = -value.imag();
      basis(lines + i, column + 1) = value.real();
    }
  }
  return basis;
}

Eigen::MatrixXd stacked_pole_derivatives(const Eigen::Ref<const Eigen::VectorXcd>& s, int power,
                                         const Eigen::Ref<const Eigen::VectorXcd>& poles,
                                         const Eigen::Ref<const Eigen::VectorXd>& line_weight) {
  Eigen::MatrixXd basis(2 * s.size(), 2 * poles.size());
  fill_pole_columns(s, power, 2, poles, line_weight, basis);
  return basis;
}

Eigen::MatrixXd stacked(const Eigen::Ref<const Eigen::MatrixXcd>& columns,
                        const Eigen::Ref<const Eigen::VectorXd>& line_weight) {
  const Index lines = columns.rows();
  Eigen::MatrixXd result(2 * lines, columns.cols());
  result.topRows(lines) = line_weight.asDiagonal() * columns.real();
  result.bottomRows(lines) = line_weight.asDiagonal() * columns.imag();
  return result;
}

}  // namespace rigfit::signal
