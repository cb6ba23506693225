// 95 % intervals of a damped sinusoid's decay rate and angular frequency, in noise too that leaves
// neither near to linear.
//
// With theta (a or w) held and all else fitted, the mode explains the energy
//   r(theta)^2 = R^2 - (RSS(theta) - RSS_min) / sigma^2,   R^2 = r(theta^)^2.
// Damped sinusoids in white noise look the same on every scale of time and beside every frequency:
// a -> s a, w -> s w + v, under which the noise does not change either. For such a family the
// distribution of estimates given what the changes leave as it is (R, and so whether the mode was
// detected) is told exactly by a density of the values themselves, the likelihood times da dw / a.
// The amplitude's phase and the other of a and w taken out by Laplace's approximation, it is
//   g(theta) = exp(mu r) / r  sqrt(V(2 a) / V(a + a^))  for theta = a, without the root for w,
// with V(q) the variance of j = 0 .. N-1 under weights exp(-q j) (1 / q^2 in a long record). mu is
// the mode's true root energy, most likely sqrt(R^2 - 3) (chi-squared with four degrees, far above
// the noise). The interval leaves 2.5 % of g on either side. Where the fit is as good as
// linear, exp(mu (r - R)) is exp(-z^2 / 2) and the interval value +- k std; sigma not being known,
// Student's law stands for the exponential.
// Sources: Fraser, The Structure of Inference (1968), ch. 2; Barndorff-Nielsen, Biometrika 67
// (1980) 293 (what is exact for such families); Tierney, Kadane, JASA 81 (1986) 82 (Laplace).
#pragma once

#include <Eigen/Core>
#include <span>

#include "signal/sinusoids/damped_sinusoids.h"

namespace rigfit::signal {

/// What is known of the mode besides its fit.
struct PoleEvidence {
  /// Std of a or w in a linear fit; in coloured noise it scales the energy for `part`.
  double std = 0;
  double energy = 0;    ///< R^2, in variances of the noise
  double strength = 0;  ///< mu
};

struct PoleInterval {
  double below = 0, above = 0;  ///< distances from the fit's value, in `std`
  bool bounded = true;          ///< false: more than 1 % of g may lie beyond what was looked at
};

/// `part`: 2 m the real, 2 m + 1 the imaginary part of pole m of `fit` to `y` (missing samples 0).
[[nodiscard]] PoleInterval pole_interval(const Eigen::Ref<const Eigen::VectorXd>& y,
                                         std::span<const Eigen::Index> missing,
                                         const DampedSinusoidsFit& fit, Eigen::Index part,
                                         const PoleEvidence& evidence);

/// Variance of j = 0 .. n-1 under weights exp(-q j).
[[nodiscard]] double index_variance(double q, Eigen::Index n);

}  // namespace rigfit::signal
