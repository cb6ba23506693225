// The functions of frequency that FRFs are sums of when the poles are given, as real least squares
// sees them.
//
// Along s = i w + sigma (sigma: decay rate of an exponential window shared by force and response,
// so that poles are those of the structure and the window needs no correction afterwards), with n =
// 0, 1, 2 for receptance, mobility, accelerance:
//   H(s) = s^n { sum_r [ R_r / (s - p_r) + conj(R_r) / (s - conj(p_r)) ] + lower / s^2 + upper }.
// H is linear in the real and imaginary parts of R_r, lower and upper (both complex here: they also
// hold what truncation of the records leaves far from a pole). Complex columns over lines become
// real ones of twice the length: real parts above imaginary parts.
#pragma once

#include <Eigen/Core>
#include <complex>

#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// Power of s that makes `form` from receptance; unknown counts as receptance.
[[nodiscard]] int power_of_s(FrfForm form);

/// s = decay_rate + i 2 pi f.
[[nodiscard]] Eigen::VectorXcd laplace_lines(const Eigen::Ref<const Eigen::VectorXd>& frequency_hz,
                                             double decay_rate_1_s);

/// Columns (R_1 real, R_1 imaginary, R_2 real, ..., lower real, imaginary, upper real, imaginary),
/// each line multiplied by `line_weight`: 2 lines x (2 poles + 4).
[[nodiscard]] Eigen::MatrixXd stacked_basis(const Eigen::Ref<const Eigen::VectorXcd>& s, int power,
                                            const Eigen::Ref<const Eigen::VectorXcd>& poles,
                                            const Eigen::Ref<const Eigen::VectorXd>& line_weight);

/// The same with 1 / (s - p)^2 in place of 1 / (s - p), without residuals: the derivatives with
/// respect to the poles are these times the residues (summed_turns()). 2 lines x 2 poles.
[[nodiscard]] Eigen::MatrixXd stacked_pole_derivatives(
    const Eigen::Ref<const Eigen::VectorXcd>& s, int power,
    const Eigen::Ref<const Eigen::VectorXcd>& poles,
    const Eigen::Ref<const Eigen::VectorXd>& line_weight);

/// Complex columns, weighted by line, as real ones of twice the length.
[[nodiscard]] Eigen::MatrixXd stacked(const Eigen::Ref<const Eigen::MatrixXcd>& columns,
                                      const Eigen::Ref<const Eigen::VectorXd>& line_weight);

/// Rows in pairs (real part, imaginary part) as complex ones.
[[nodiscard]] inline Eigen::MatrixXcd from_pairs(const Eigen::MatrixXd& rows) {
  return Eigen::Map<const Eigen::MatrixXcd>(
      reinterpret_cast<const std::complex<double>*>(rows.data()), rows.rows() / 2, rows.cols());
}

/// Sum over FRFs c of weight_c T_c' A T_c with T_c = [a -b; b a] for each mode's residue a + i b:
/// what turns the columns of stacked_pole_derivatives() to derivatives of FRF c. `residues`: modes
/// x FRFs.
[[nodiscard]] Eigen::MatrixXd summed_turns(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                           const Eigen::Ref<const Eigen::MatrixXcd>& residues,
                                           const Eigen::Ref<const Eigen::VectorXd>& weight);

/// FRFs of given poles, residues (modes x FRFs) and residuals: lines x FRFs.
[[nodiscard]] Eigen::MatrixXcd synthesise(const Eigen::Ref<const Eigen::VectorXcd>& s, int power,
                                          const Eigen::Ref<const Eigen::VectorXcd>& poles,
                                          const Eigen::Ref<const Eigen::MatrixXcd>& residues,
                                          const Eigen::Ref<const Eigen::VectorXcd>& lower,
                                          const Eigen::Ref<const Eigen::VectorXcd>& upper);

}  // namespace rigfit::signal
