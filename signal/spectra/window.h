// Force and exponential windows for impact tests.
//
// The force window is 1 during the pulse, rises to it and falls from it by half cosines, and is 0
// elsewhere, where the channel holds only noise. The exponential window w(t) = exp(-a t) is applied
// to force and response. Since both become functions of s = i omega + a, their ratio is the FRF on
// that line of the s plane: every pole moves by -a, no amplitude changes, and the poles are
// corrected by +a afterwards. Source: Fladung, Rost, "Application and correction of the exponential
// window", Mechanical Systems and Signal Processing 11 (1997) 23-36.
#pragma once

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

/// exp(-a n / rate), n = 0 .. length - 1.
[[nodiscard]] VectorXd exponential_window(Index length, double sample_rate_hz,
                                          double decay_rate_1_s);

/// a of the window that has fallen to `end_level` (0..1) after `duration_s`.
[[nodiscard]] double decay_rate_for(double end_level, double duration_s);

/// 1 for samples first .. last - 1, half cosines over `taper` samples on either side, else 0.
[[nodiscard]] VectorXd force_window(Index length, Index first, Index last, Index taper);

}  // namespace rigfit::signal
