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

#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// Power of s that makes `form` from receptance; unknown counts as receptance.
[[nodiscard]] int power_of_s(FrfForm form);

/// s = decay_rate + i 2 pi f.
[[nodiscard]] VectorXcd laplace_lines(const Ref<const VectorXd>& frequency_hz,
                                      double decay_rate_1_s);

/// Columns (R_1 real, R_1 imaginary, R_2 real, ..., lower real, imaginary, upper real, imaginary,
/// then two a column of `background`), each line multiplied by `line_weight`: 2 lines x (2 poles +
/// 4 + 2 terms).
[[nodiscard]] MatrixXd stacked_basis(const Ref<const VectorXcd>& s, int power,
                                     const Ref<const VectorXcd>& poles,
                                     const Ref<const VectorXd>& line_weight,
                                     const Ref<const MatrixXcd>& background = MatrixXcd());

/// The same with 1 / (s - p)^2 in place of 1 / (s - p), without residuals: the derivatives with
/// respect to the poles are these times the residues (summed_turns()). 2 lines x 2 poles.
[[nodiscard]] MatrixXd stacked_pole_derivatives(const Ref<const VectorXcd>& s, int power,
                                                const Ref<const VectorXcd>& poles,
                                                const Ref<const VectorXd>& line_weight);

/// Complex columns, weighted by line, as real ones of twice the length.
[[nodiscard]] MatrixXd stacked(const Ref<const MatrixXcd>& columns,
                               const Ref<const VectorXd>& line_weight);

/// Rows in pairs (real part, imaginary part) as complex ones.
[[nodiscard]] inline MatrixXcd from_pairs(const MatrixXd& rows) {
  return Map<const MatrixXcd>(reinterpret_cast<const Complex*>(rows.data()), rows.rows() / 2,
                              rows.cols());
}

/// Sum over FRFs c of weight_c T_c' A T_c with T_c = [a -b; b a] for each mode's residue a + i b:
/// what turns the columns of stacked_pole_derivatives() to derivatives of FRF c. `residues`: modes
/// x FRFs.
[[nodiscard]] MatrixXd summed_turns(const Ref<const MatrixXd>& A,
                                    const Ref<const MatrixXcd>& residues,
                                    const Ref<const VectorXd>& weight);

/// FRFs of given poles, residues (modes x FRFs) and residuals: lines x FRFs.
[[nodiscard]] MatrixXcd synthesise(const Ref<const VectorXcd>& s, int power,
                                   const Ref<const VectorXcd>& poles,
                                   const Ref<const MatrixXcd>& residues,
                                   const Ref<const VectorXcd>& lower,
                                   const Ref<const VectorXcd>& upper);

}  // namespace rigfit::signal
