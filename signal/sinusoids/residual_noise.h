// What a fit leaves, and what it means for the fit's uncertainties: noise that is coloured, and
// noise whose variance changes along the record.
//
// The residual is modelled as an autoregression r_j = sum_k a_k r_{j-k} + e_j, order by Schwarz's
// criterion (order 0: white). A parameter's error is sum_j w_j r_j, w a column of J (J'J)^-1, that
// is sum_j v_j e_j with v_j = w_j + sum_k a_k v_{j+k}, so that the covariance of the fit is
//   s^2 sum_j v_j v_j',   s^2 the variance of e:
// for white noise s^2 (J'J)^-1, the Cramer-Rao bound. Where the variance of e changes it is White's
// sandwich, with e_j^2 / (1 - h_j) for s^2, h_j the sample's leverage (HC2: unbiased where the
// variance is constant). That a parameter's variance is more so is White's test in Koenker's form,
// which does not take the noise for Gaussian:
//   z = sum_j v_j^2 (e_j^2 - s^2) / sqrt(sum_j (v_j^2 - mean v^2)^2 var(e^2)).
// Jitter of the sampling clock, noise in proportion to the signal and converter steps are such
// noise. Sources: Kay, Modern Spectral Estimation (1988), ch. 6; White, Econometrica 48 (1980) 817;
// MacKinnon and White, J. Econometrics 29 (1985) 305; Koenker, J. Econometrics 17 (1981) 107;
// Andrews and Monahan, Econometrica 60 (1992) 953 (prewhitening).
#pragma once

#include "signal/sinusoids/damped_sinusoids.h"

namespace rigfit::signal {

struct ResidualNoise {
  double variance = 0;             ///< noise variance, corrected for the fit's degrees of freedom
  double innovation_variance = 0;  ///< variance of e
  VectorXd coefficients;           ///< a_1 .. a_p; empty: white

  /// Variance of white noise with the same density at `frequency` (cycles per sample).
  [[nodiscard]] double white_equivalent(double frequency) const;
};

/// `degrees`: samples less fitted parameters.
[[nodiscard]] ResidualNoise residual_noise(const Ref<const VectorXd>& residual, Index degrees);

struct FitUncertainty {
  MatrixXd covariance;  ///< under noise of constant variance
  /// Factor on the variance of each parameter, order of `DampedSinusoidsFit::jacobian_gram`: the
  /// sandwich's where z is above 3.09, which even noise exceeds once in a thousand times, else 1.
  ArrayXd widening;

  /// The largest factor of a mode's four parameters.
  [[nodiscard]] double widening_of_mode(std::size_t m) const {
    return widening.segment<4>(static_cast<Index>(4 * m)).maxCoeff();
  }
};

/// `fit` must not be rank-deficient.
[[nodiscard]] FitUncertainty fit_uncertainty(const DampedSinusoidsFit& fit,
                                             const ResidualNoise& noise);

}  // namespace rigfit::signal
