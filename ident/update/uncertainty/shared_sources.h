// What moves many residuals of an update together: the error of the segments, what is taken as
// known with an uncertainty, and where a hammer struck in the mean of its hits.
//
// One standard uncertainty of input k changes the residuals (over their own standard deviations)
// by c_k; with C = [c_1 ...] their covariance is I + C C'. A fit of FRFs minimises r' (I + C C')^-1
// r: with C = U S V', residuals and Jacobian are multiplied by
//   L = I - U (1 - (1 + S^2)^(-1/2)) U',   L' L = (I + C C')^-1.
// Its covariance (J' L' L J)^-1 holds the inputs' part; chi-square is |L r|^2 for every kind of
// data. Without that, one hammer 3 mm off counts as an error of the model in a thousand lines. The
// error of the segments is no such source: it is known, and not linear in h^2 where it moves a
// resonance by a part of its width (update_segments.h).
//
// The place of the hits: an error bar of an averaged FRF holds what the hits scatter by, and hits
// scatter in place. sigma_x |dH/dx| <= std(H) in every line bounds the standard uncertainty of
// their mean place x along the member; the bound (its 5 % quantile over the lines, as error bars
// scatter) is taken where nothing else is said of the place. A mean that was aimed beside is not in
// the hits' scatter and must be stated.
//
// What the hits scatter by is in the error bars of the lines and, as a bound, in C: intervals are
// too wide by that at most, never too narrow.
//
// The force of the hits: noise n(t) on the hammer's signal moves H by the factor 1 - N / F, alike
// in all responses, and where a window keeps only the pulse, alike in neighbouring lines:
//   N / F = sum_j a_j exp(-i omega tau_j),  |tau_j| <= T / 2.
// A pulse that excites lines up to f lasts 1.5 / f at most (half sine), and windows keep three
// pulses, faded over half as long: T = 6.75 / f. The a_j are independent; what they add up to in a
// line is bounded as the place is, by the 5 % quantile of the lines' relative uncertainties.
// Source: Aitken's generalised least squares, e.g. Rao, Linear Statistical Inference, 4a.
//
// Lines that err together. The noise that a force window leaves, the smallest part of a place that
// is not taken out and a model that is a little off move neighbouring lines alike, and all
// responses of a load. With z_k the complex residual of line k after the fit, over its standard
// deviation,
//   R_l = mean Re(conj(z_k) z_(k+l)) / 2
// correlates each FRF with itself and with those of the same load. For the probability of the
// misfit lines count as one by the integrated autocorrelation time t = 1 + 2 sum_l R_l / R_0, up to
// the first R_l / R_0 below 2 / sqrt(lines) (Bartlett's effective number of samples). A parameter
// feels the correlation only as far as its derivatives reach, which is the width of a resonance:
// its variance is that of the sandwich
//   B M B,  B = (J' J)^-1,  M = sum of s_g s_g', s_g = J' r of a block of 2 t lines of all
//   responses of a load (other data: their part of J' J),
// and at least R_0 t B. Sources: Bartlett, J. R. Stat. Soc. 98 (1935) 536; White, Econometrica 48
// (1980) 817; Liang and Zeger, Biometrika 73 (1986) 13. For the update and its checks, not
// for users.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {

struct SharedChanges {
  std::vector<std::string> names;    ///< "segments", "force of ...", the inputs; one a column
  std::vector<Eigen::Index> inputs;  ///< which input each column is; -1: none
  Eigen::MatrixXd changes;           ///< residuals' changes by one standard uncertainty
  std::string message;               ///< sources that could not be evaluated, "; " after each
};

/// Of `problem` as it is (its residuals may be multiplied by L), at q. `segments`: theirs is the
/// first column.
[[nodiscard]] SharedChanges shared_changes(const UpdateProblem& problem, bool segments,
                                           const std::vector<UpdateMatch>& matches,
                                           const Eigen::VectorXd& q);

/// `problem` with its residuals multiplied by L, C found at q, and its inputs moved to where the
/// residuals want them: repeated with q, that solves for both without linearising H in the place of
/// a hammer.
[[nodiscard]] UpdateProblem with_shared_sources(const UpdateProblem& problem,
                                                const std::vector<UpdateMatch>& matches,
                                                const Eigen::VectorXd& q);

/// t of the residuals r of the problem's FRFs, 1 or more; 1 without FRFs.
[[nodiscard]] double correlated_lines_of(const UpdateProblem& problem,
                                         const std::vector<UpdateMatch>& matches,
                                         const Eigen::VectorXd& r);

/// The largest ratio of a coordinate's variance to that in B, at q with its residuals and
/// derivatives: of B M B, of R_0 t B, and of the squared step to the estimate that takes no shared
/// source out of its residuals, where that is larger than its variance, that of the less exact
/// estimate less that of this one, explains (5 %): then something else is shared than the sources,
/// such as a hammer aimed beside (Hausman, Econometrica 46 (1978) 1251). 0 without FRFs.
[[nodiscard]] double correlated_variance_factor(const UpdateProblem& problem,
                                                const std::vector<UpdateMatch>& matches,
                                                const Eigen::VectorXd& q, const Eigen::VectorXd& r,
                                                const Eigen::MatrixXd& J);

/// Residuals changed by 4/3 of the difference between n and 2 n segments; false without a model.
/// `value` gives what is compared of a problem.
template <typename Value>
[[nodiscard]] bool change_by_segments(const UpdateProblem& problem, const Value& value,
                                      Eigen::VectorXd& change) {
  constexpr double kRichardson = 4.0 / 3;
  Eigen::VectorXd here, fine;
  if (!value(problem, here) ||
      !value(problem.with(&UpdateVariant::segment_factor, 2 * problem.variant().segment_factor),
             fine)) {
    return false;
  }
  change = kRichardson * (here - fine);
  return true;
}

/// The same by one standard uncertainty of an input, from differences over it.
template <typename Value>
[[nodiscard]] bool change_by_input(const UpdateProblem& problem, Eigen::Index input,
                                   const Value& value, Eigen::VectorXd& change) {
  constexpr double kStep = 0.5;  // standard uncertainties, to either side
  const Eigen::VectorXd off = problem.inputs_off();
  const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(off.size(), input);
  Eigen::VectorXd up, down;
  if (!value(problem.with(&UpdateVariant::inputs_off, off + step), up)) return false;
  if (!value(problem.with(&UpdateVariant::inputs_off, off - step), down)) return false;
  change = (up - down) / (2 * kStep);
  return true;
}

}  // namespace rigfit::ident
