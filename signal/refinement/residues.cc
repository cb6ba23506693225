#include "signal/refinement/residues.h"

#include <complex>
#include <stdexcept>

#include "signal/numerics/least_squares.h"
#include "signal/refinement/modal_basis.h"

namespace rigfit::signal {

using Eigen::Index;

void unpack_coefficients(const Eigen::Ref<const Eigen::MatrixXd>& coefficients,
                         Eigen::MatrixXcd& residues, Eigen::VectorXcd& lower,
                         Eigen::VectorXcd& upper) {
  const Index modes = (coefficients.rows() - 4) / 2;
  residues.resize(modes, coefficients.cols());
  lower.resize(coefficients.cols());
  upper.resize(coefficients.cols());
  for (Index c = 0; c < coefficients.cols(); ++c) {
    for (Index r = 0; r < modes; ++r) {
      residues(r, c) = {coefficients(2 * r, c), coefficients(2 * r + 1, c)};
    }
    lower[c] = {coefficients(2 * modes, c), coefficients(2 * modes + 1, c)};
    upper[c] = {coefficients(2 * modes + 2, c), coefficients(2 * modes + 3, c)};
  }
}

Eigen::MatrixXd pack_coefficients(const Eigen::Ref<const Eigen::MatrixXcd>& residues,
                                  const Eigen::Ref<const Eigen::VectorXcd>& lower,
                                  const Eigen::Ref<const Eigen::VectorXcd>& upper) {
  const Index modes = residues.rows();
  Eigen::MatrixXd coefficients(2 * modes + 4, residues.cols());
  for (Index r = 0; r < modes; ++r) {
    coefficients.row(2 * r) = residues.row(r).real();
    coefficients.row(2 * r + 1) = residues.row(r).imag();
  }
  coefficients.row(2 * modes) = lower.real().transpose();
  coefficients.row(2 * modes + 1) = lower.imag().transpose();
  coefficients.row(2 * modes + 2) = upper.real().transpose();
  coefficients.row(2 * modes + 3) = upper.imag().transpose();
  return coefficients;
}

ResidueResult fit_residues(const Eigen::Ref<const Eigen::VectorXcd>& s, int power,
                           const Eigen::Ref<const Eigen::MatrixXcd>& H,
                           const Eigen::Ref<const Eigen::VectorXcd>& poles,
                           const Eigen::VectorXd& line_weight) {
  if (H.rows() != s.size() || (line_weight.size() != 0 && line_weight.size() != s.size())) {
    throw std::invalid_argument("fit_residues: sizes do not fit");
  }
  const Eigen::VectorXd weight = line_weight.size() ? line_weight : Eigen::VectorXd::Ones(s.size());
  Eigen::MatrixXd basis = stacked_basis(s, power, poles, weight);
  const Eigen::VectorXd length = basis.colwise().stableNorm().transpose().cwiseMax(1e-300);
  basis *= length.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd y = stacked(H, weight);
  const LeastSquares solved = least_squares(basis, y);

  ResidueResult result;
  result.squared_misfit = solved.left_sum_squares;
  result.condition = solved.condition;
  const Eigen::MatrixXd coefficients = length.cwiseInverse().asDiagonal() * solved.x;
  unpack_coefficients(coefficients, result.residues, result.lower, result.upper);
  return result;
}

Eigen::MatrixXcd synthesise(const Eigen::Ref<const Eigen::VectorXcd>& s, int power,
                            const Eigen::Ref<const Eigen::VectorXcd>& poles,
                            const Eigen::Ref<const Eigen::MatrixXcd>& residues,
                            const Eigen::Ref<const Eigen::VectorXcd>& lower,
                            const Eigen::Ref<const Eigen::VectorXcd>& upper) {
  const Eigen::MatrixXd values = stacked_basis(s, power, poles, Eigen::VectorXd::Ones(s.size())) *
                                 pack_coefficients(residues, lower, upper);
  Eigen::MatrixXcd H(s.size(), residues.cols());
  H.real() = values.topRows(s.size());
  H.imag() = values.bottomRows(s.size());
  return H;
}

}  // namespace rigfit::signal
