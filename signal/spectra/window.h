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
[[nodiscard]] inline VectorXd exponential_window(Index length, double sample_rate_hz,
                                                 double decay_rate_1_s) {
  return VectorXd::NullaryExpr(length, [=](Index n) {
    return std::exp(-decay_rate_1_s * static_cast<double>(n) / sample_rate_hz);
  });
}

/// a of the window that has fallen to `end_level` (0..1) after `duration_s`.
[[nodiscard]] inline double decay_rate_for(double end_level, double duration_s) {
  if (!(end_level > 0 && end_level <= 1 && duration_s > 0)) {
    throw std::invalid_argument("an exponential window ends between 0 (not included) and 1");
  }
  return -std::log(end_level) / duration_s;
}

/// 1 for samples first .. last - 1, half cosines over `taper` samples on either side, else 0.
[[nodiscard]] inline VectorXd force_window(Index length, Index first, Index last, Index taper) {
  return VectorXd::NullaryExpr(length, [=](Index n) {
    const Index outside = n < first ? first - n : n - last + 1;  // samples away from the flat part
    if (outside <= 0) return 1.0;
    if (outside > taper) return 0.0;
    const double x = static_cast<double>(outside) / static_cast<double>(taper + 1);
    return 0.5 * (1 + std::cos(std::numbers::pi * x));
  });
}

}  // namespace rigfit::signal
