// Tones that do not decay (mains hum, a machine) beside a decay, from where they stand alone.
//
// A tone within a line's width of a mode cannot be told from it while the mode lasts, but it can
// before the impact and behind the decay. A line found there is fitted as
//   Re(C exp(i w j)),  w and C free, no decay,
// to all samples before the impact and in the window, together with the modes: the modes are fitted
// to the window, less the tones; the tones take a step of Gauss and Newton's for the fit of both,
// in which the modes follow; in turns. The modes' covariance is that of the fit of both.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "signal/sinusoids/damped_sinusoids.h"

namespace rigfit::signal {

struct DecayTone {
  double w = 0;                    ///< rad per sample
  std::complex<double> amplitude;  ///< at sample 0 of the record
};

/// Where tones are looked for, samples of the record.
struct ToneStretches {
  Eigen::Index quiet = 0;           ///< samples [0, quiet) lie before the impact
  Eigen::Index start = 0, end = 0;  ///< the window that was fitted
};

/// Tones of the record `y` (NaN where missing) beside the modes of `fit` to the window. Empty when
/// none stands out of the noise where it is alone.
[[nodiscard]] std::vector<DecayTone> steady_tones(const Eigen::Ref<const Eigen::VectorXd>& y,
                                                  const ToneStretches& stretches,
                                                  const DampedSinusoidsFit& fit,
                                                  double false_alarm);

/// The record without the tones.
void subtract_tones(Eigen::VectorXd& y, const std::vector<DecayTone>& tones);

/// (J'J)^-1 of the modes of `fit`, to the window without the tones, when the tones are fitted too;
/// empty when they cannot be told apart.
[[nodiscard]] Eigen::MatrixXd covariance_beside_tones(const DampedSinusoidsFit& fit,
                                                      const std::vector<DecayTone>& tones,
                                                      const ToneStretches& stretches);

}  // namespace rigfit::signal
