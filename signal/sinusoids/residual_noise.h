// The colour of what a fit leaves, and what it means for the fit's uncertainties.
//
// The residual is modelled as an autoregression r_j = sum_k a_k r_{j-k} + e_j, order by Schwarz's
// criterion (order 0: white). The covariance of a least-squares fit under such noise is the
// sandwich  (J'J)^-1 (J' S J) (J'J)^-1,  S the Toeplitz covariance of the noise, evaluated in the
// frequency domain. For white noise it is s^2 (J'J)^-1, the Cramer-Rao bound.
// Sources: Kay, Modern Spectral Estimation (1988), ch. 6 (Levinson-Durbin); Priestley, Spectral
// Analysis and Time Series (1981), section 5.4.
#pragma once

#include <Eigen/Core>

#include "signal/sinusoids/damped_sinusoids.h"

namespace rigfit::signal {

struct ResidualNoise {
  double variance = 0;             ///< noise variance, corrected for the fit's degrees of freedom
  double innovation_variance = 0;  ///< variance of e
  Eigen::VectorXd coefficients;    ///< a_1 .. a_p; empty: white

  /// Variance of white noise with the same density at `frequency` (cycles per sample).
  [[nodiscard]] double white_equivalent(double frequency) const;
};

/// `degrees`: samples less fitted parameters.
[[nodiscard]] ResidualNoise residual_noise(const Eigen::Ref<const Eigen::VectorXd>& residual,
                                           Eigen::Index degrees);

/// Sum of squares of what an autoregression of that order leaves of `x` (zeros where missing).
[[nodiscard]] double prediction_error(const Eigen::Ref<const Eigen::VectorXd>& x,
                                      Eigen::Index order);

/// Covariance of the fit's parameters (order of `jacobian_gram`) under that noise; empty when the
/// fit is rank-deficient.
[[nodiscard]] Eigen::MatrixXd fit_covariance(const DampedSinusoidsFit& fit,
                                             const ResidualNoise& noise);

}  // namespace rigfit::signal
