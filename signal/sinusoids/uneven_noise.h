// Noise whose variance changes along the record: what it does to the uncertainties of a fit.
//
// A least-squares fit to noise of variance v_j has the covariance of White's sandwich,
//   var(theta_k) = sum_j w_kj v_j,   w_kj = (row j, element k of J (J'J)^-1)^2,
// with e_j^2 / (1 - h_j) for v_j, e the residual and h_j the sample's leverage (HC2: unbiased where
// v is constant). Where v is the constant s^2 it is s^2 sum_j w_kj. That it is more is White's
// test, for one parameter and in Koenker's form, which does not take the noise for Gaussian:
//   z_k = sum_j w_kj (e_j^2 - s^2) / sqrt(sum_j (w_kj - mean w_k)^2 var(e^2)).
// Jitter of the sampling clock, noise in proportion to the signal and converter steps are such
// noise. In coloured noise e are the innovations of the residual's autoregression, and the columns
// of J (J'J)^-1 are filtered by its transpose (prewhitening, Andrews and Monahan).
// Sources: White, Econometrica 48 (1980) 817; MacKinnon and White, J. Econometrics 29 (1985) 305;
// Koenker, J. Econometrics 17 (1981) 107; Andrews and Monahan, Econometrica 60 (1992) 953.
#pragma once

#include <Eigen/Core>

#include "signal/sinusoids/damped_sinusoids.h"
#include "signal/sinusoids/residual_noise.h"

namespace rigfit::signal {

/// An element a parameter, order of `DampedSinusoidsFit::jacobian_gram`.
struct UnevenNoise {
  Eigen::VectorXd variance_ratio;  ///< the sandwich's variance over that under constant variance
  Eigen::VectorXd deviation;       ///< z

  /// Factor on the variance of parameter k: 1 where z is below 3.09, which even noise exceeds once
  /// in a thousand times.
  [[nodiscard]] double widening(Eigen::Index k) const;
  /// The covariance of the fit under constant variance, widened.
  [[nodiscard]] Eigen::MatrixXd widened(const Eigen::Ref<const Eigen::MatrixXd>& covariance) const;
};

/// `fit` must not be rank-deficient.
[[nodiscard]] UnevenNoise uneven_noise(const DampedSinusoidsFit& fit, const ResidualNoise& noise);

}  // namespace rigfit::signal
