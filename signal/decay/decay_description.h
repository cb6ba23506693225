// The numbers of a fit of damped sinusoids: its modes with uncertainties, in coloured noise and
// noise that is larger while the mode moves (residual_noise.h), the log decrement and the envelope
// of each. decay_judgement.h decides which of them are given.
#pragma once

#include <vector>

#include "signal/decay/decay_result.h"
#include "signal/sinusoids/decay_modes.h"
#include "signal/sinusoids/residual_noise.h"

namespace rigfit::signal {

struct DescribedFit {
  const DampedSinusoidsFit& fit;
  double false_alarm = 0;
  ResidualNoise noise;
  LineSpectrum residual;                  ///< of the fit
  std::vector<DecayMode> modes;           ///< order of the fit
  std::vector<EnvelopeResult> envelopes;  ///< by mode
  Eigen::MatrixXd covariance;             ///< of (f_1, zeta_1, f_2, ...), Hz and 1
  /// Time constants in the window, and their standard uncertainty, by mode.
  std::vector<double> fall, fall_std;

  /// White-equivalent variance of a sample beside the angular frequency `w`: what the fit leaves at
  /// a mode itself is no noise.
  [[nodiscard]] double noise_beside(double w) const;
};

/// Intervals are those of the fit's covariance and Student's law, wider where the residual holds
/// more at the mode than its colour says. `fit` must not be rank-deficient and must live on.
[[nodiscard]] DescribedFit describe_fit(const DampedSinusoidsFit& fit, double sample_rate_hz,
                                        double false_alarm);

}  // namespace rigfit::signal
