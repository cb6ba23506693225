// A low-pass by Kaiser's design: a sinc whose edge lies midway between pass and stop band, under
// his window of the length and the shape that the attenuation takes. Source: Oppenheim and Schafer,
// Discrete-Time Signal Processing, 7.5.3.
#pragma once

#include <gsl/gsl_sf_bessel.h>

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

class LowPass {
 public:
  /// The bands' edges, Hz (or over any rate, times being in its samples), `pass` < `stop`; dB.
  LowPass(double pass, double stop, double attenuation_db)
      : edge_(kTwoPi * (pass + stop) / 2),
        half_((attenuation_db - 7.95) / (2 * 2.285 * kTwoPi * (stop - pass))),
        beta_(0.1102 * (attenuation_db - 8.7)) {}

  /// Half the window's length, from where on weights are 0.
  [[nodiscard]] double half_length() const { return half_; }
  /// The weight at a time off the middle, 1 in it; weights that are used add up to 1 when scaled.
  [[nodiscard]] double at(double time) const {
    const double angle = edge_ * time, part = time / half_;
    if (std::abs(part) >= 1) return 0;
    return (angle == 0 ? 1 : std::sin(angle) / angle) *
           gsl_sf_bessel_I0(beta_ * std::sqrt(1 - part * part)) / gsl_sf_bessel_I0(beta_);
  }

 private:
  double edge_, half_, beta_;
};

}  // namespace rigfit::signal
