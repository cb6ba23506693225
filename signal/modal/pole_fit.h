// Poles of FRFs in a window of lines by separable least squares.
//
//   H_c(s_k) = sum_r a_rc / (s_k - p_r) + sum_h a_hc / (s_k - p_h) + sum_j b_jc P_j(f_k) + e_kc
// r: poles sought, h: poles beside the window (held), P_j: polynomials of degree 0..2. All
// coefficients are free complex numbers: s^n of an accelerance, conjugate poles, residual terms,
// the cut end of a record and noise of a force kept over its pulse only are each "a pole at the
// same place plus something smooth", so none has a term of its own.
//
// P_j and held poles are projected off once a window (Q), for all FRFs. With X = (I - Q Q^H) [1/(s
// - p), 1/(s - p)^2] all that the fit needs is A = X^H X and B = X^H Y:
//   a = A11^-1 B1,   N = (A22 - A21 A11^-1 A12) o (conj(a) W a^T),   g = sum_c w_c conj(a_c) o (B2
//   - A21 a)_c
// (Kaufman's variable projection; o: element by element). The model is holomorphic in p, hence the
// step (N + lambda diag N)^-1 g is complex and Var Re p = Var Im p = (N^-1)_rr / 2 for w = 1 /
// E|e|^2. Source: Golub and Pereyra, Inverse Problems 19 (2003) R1; Kaufman, BIT 15 (1975) 49.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "signal/modal/modal_data.h"

namespace rigfit::signal {

/// Lines around poles; their FRFs without background and without the poles held beside.
struct PoleWindow {
  Eigen::Index first = 0;  ///< line
  Eigen::VectorXcd s;
  Eigen::MatrixXcd Q;  ///< orthonormal: what is projected off
  Eigen::MatrixXcd Y;  ///< lines x columns
};

struct PoleFit {
  Eigen::VectorXcd poles;         ///< m
  Eigen::MatrixXcd residues;      ///< m x columns: a
  Eigen::MatrixXcd normal;        ///< N: m x m
  Eigen::MatrixXcd pull;          ///< m x columns: what each column adds to the gradient g
  Eigen::VectorXd squares;        ///< columns: sum of |e|^2 left
  Eigen::VectorXd weights;        ///< columns: 1 / E|e|^2
  Eigen::MatrixXcd gram_inverse;  ///< A11^-1
  Eigen::MatrixXcd turn;          ///< A11^-1 A12: da = -turn (a o dp)
  Eigen::MatrixXcd schur;         ///< A22 - A21 A11^-1 A12
  double freedom = 1;             ///< complex, of each column, lines taken as independent
};

/// At most so many Gauss-Newton steps from `poles`, damped, each at most a half bandwidth. Columns
/// of `Y` begin at `first`; `weights`: as many as columns.
[[nodiscard]] PoleFit fit_poles(const PoleWindow& window, Eigen::Index first,
                                const Eigen::VectorXd& weights, const Eigen::VectorXcd& poles,
                                int steps);

/// Poles common to all columns, weights from what the fit leaves of each.
[[nodiscard]] PoleFit fit_common_poles(const PoleWindow& window, const Eigen::VectorXcd& poles);

/// The window with other poles projected off as well.
[[nodiscard]] PoleWindow with_held(const PoleWindow& window, const Eigen::VectorXcd& poles);

/// 1/(s - p) in the window less what `window.Q` has of it: lines x poles.
[[nodiscard]] Eigen::MatrixXcd resonances(const PoleWindow& window, const Eigen::VectorXcd& poles);

/// Joint covariance of the poles (complex, E dp dp^H) where noise of lines correlates as `data`
/// says: N^-1 times what correlation adds.
[[nodiscard]] Eigen::MatrixXcd pole_covariance(const ModalData& data, const PoleWindow& window,
                                               const PoleFit& fit);

/// Variance that noise of correlated lines gives a resonance's size and its pole, over that of
/// independent lines.
struct CorrelatedNoise {
  double of_size = 1, of_pole = 1;
};
[[nodiscard]] CorrelatedNoise correlated_noise(const ModalData& data, const PoleWindow& window,
                                               std::complex<double> pole);

/// Increase of the squares without each pole, in noise variances per unknown: an F statistic.
[[nodiscard]] Eigen::VectorXd gains(const ModalData& data, const PoleWindow& window,
                                    const PoleFit& fit);

/// Poles that overlap, together: neighbours nearer than twice the sum of their half bandwidths.
[[nodiscard]] std::vector<std::vector<Eigen::Index>> blocks_of(const ModalData& data,
                                                               const Eigen::VectorXcd& poles);

/// 15 half bandwidths on either side of the poles `block` of `poles`, 12 lines at least. Others up
/// to 1.5 widths beside the window are held. `Y`: lines of `data` x columns.
[[nodiscard]] PoleWindow window_of(const ModalData& data,
                                   const Eigen::Ref<const Eigen::MatrixXcd>& Y,
                                   const Eigen::VectorXcd& poles,
                                   const std::vector<Eigen::Index>& block);

/// Orthonormal polynomials of degree 0..2 over `lines` equal steps.
[[nodiscard]] Eigen::MatrixXcd smooth_basis(Eigen::Index lines);

/// Probability of an F statistic as large as this by chance.
[[nodiscard]] double chance_of(double F, double numerator, double denominator);

}  // namespace rigfit::signal
