// Noise model of a set of FRFs in few numbers, for weights, covariances and tests of modes.
//
// Noise of the responses gives each FRF an error of its own; noise of a force multiplies all FRFs
// of its input by the same random factor. Both are divided by the same force spectrum:
//   var Re(error_kc) = var Im(error_kc) = q_k (a_c + b_i |H_kc|^2),   i: input of column c,
// the b part being common to the FRFs of an input. Error bars from a few hits scatter by
// tens of percent from line to line; weights made of each alone would lose information and
// understate uncertainties. The smoothed q averages thousands of them over lines and FRFs.
//
// Lines of records weighted by an exponential window exp(-sigma t) of length T have correlated
// errors
//   rho(d) = exp(i 2 pi d t0 / T) / (1 + i pi d / (sigma T)),   d: difference of line numbers, T =
//   1 / line spacing, t0: from the beginning of the record to the hit,
// (the transform of exp(-2 sigma t) from -t0 on, truncated at T; FRFs count time from the hit);
// without a window they are independent.
#pragma once

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

struct FrfNoise {
  VectorXd line;                 ///< q: lines, mean 1
  VectorXd column;               ///< a: FRFs, units of H squared; infinite for an FRF that is zero
  VectorXd common;               ///< b: inputs, relative to |H|^2
  double correlation_lines = 0;  ///< sigma T; 0: lines are independent
  double lead = 0;               ///< t0 / T

  [[nodiscard]] Index inputs() const { return common.size(); }
};

/// Noise from the standard deviations (same size as `H`) of an average over hits.
[[nodiscard]] FrfNoise noise_from_std(const Ref<const MatrixXcd>& H,
                                      const Ref<const MatrixXd>& H_std, Index inputs,
                                      double correlation_lines, double lead = 0);

/// Noise from the `residual` of a fit `model`. `leverage`: lines, the share (0..1) of each line's
/// freedom that the fit has used up, mean over FRFs.
[[nodiscard]] FrfNoise noise_from_residuals(const Ref<const MatrixXcd>& model,
                                            const Ref<const MatrixXcd>& residual,
                                            const Ref<const VectorXd>& leverage, Index inputs,
                                            double correlation_lines, double lead = 0);

/// Noise when nothing is known: each FRF's variance is its mean square, the same at all lines.
[[nodiscard]] FrfNoise noise_unknown(const Ref<const MatrixXcd>& H, Index inputs,
                                     double correlation_lines, double lead = 0);

/// Weight of each line, shared by all FRFs: 1 / sqrt(q (1 + sum_i b_i h_i)), h_i = sum_c |H|^2 /
/// a_c. With it the direction of H across the FRFs, which carries what a resonance tells about its
/// pole, has the weight of generalised least squares.
[[nodiscard]] VectorXd line_weight(const FrfNoise& noise, const Ref<const MatrixXcd>& H);

/// rho(d), d >= 0.
[[nodiscard]] Complex line_correlation(const FrfNoise& noise, Index d);

/// rho applied to columns of stacked real and imaginary parts (modal_basis.h), 2 lines x n.
[[nodiscard]] MatrixXd correlated(const FrfNoise& noise,
                                  const Ref<const MatrixXd>& stacked_columns);

/// 1 / a_c of each FRF, 0 for one that takes no part.
[[nodiscard]] VectorXd inverse_variance_of(const FrfNoise& noise);

}  // namespace rigfit::signal
