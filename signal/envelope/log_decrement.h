// Logarithmic decrement from the extremes of a decay.
//
// Extremes x_k, half a cycle apart, are found between the samples by band-limited (windowed-sinc)
// interpolation. Swings d_k = |x_k - x_{k+1}| are free of an offset and decay like the motion, so
//   ln d_k = const - k delta / 2,   zeta = delta / sqrt(4 pi^2 + delta^2),
// by regression weighted with d_k^2 (the noise of ln d_k goes as 1 / d_k).
// Source: Inman, Engineering Vibration, section 1.6. It is biased by noise on the peaks and
// blind to a second mode, and serves as a check of `decay`, not as its replacement.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "signal/numerics/estimate.h"

namespace rigfit::signal {

struct LogDecrementOptions {
  double noise_std = 0;    ///< noise of a sample, signal's unit; 0: from the regression
  double least_swing = 6;  ///< swings below this many noise_std are not used
};

struct LogDecrementResult {
  Estimate log_decrement;             ///< per cycle
  Estimate damping_ratio;             ///< NaN when refused
  Estimate frequency_hz;              ///< damped: from the times of the extremes
  std::vector<double> time_s, swing;  ///< middle time and d_k of each swing used
  double r_squared = 0;               ///< weighted R^2 of the regression of ln d on k
  std::string refusal;                ///< why there is no result; empty when there is one
};

/// `y`: one mode without strong drift. `frequency_hz`: its damped frequency, to some per cent.
[[nodiscard]] LogDecrementResult log_decrement(const Eigen::Ref<const Eigen::VectorXd>& y,
                                               double sample_rate_hz, double frequency_hz,
                                               const LogDecrementOptions& options = {});

}  // namespace rigfit::signal
