#include "ident/plan/decay_bound.h"

#include <cmath>

namespace rigfit::ident {

DecayInformation decay_information(double signal_to_noise, double decay_rate_1_s, double duration_s,
                                   double rate_hz) {
  constexpr double kSeries = 1e-2;  // below it the series errs by x^4 / 6048 < 2e-12
  const double x = 2 * decay_rate_1_s * duration_s;
  const double mean = x > 0 ? -std::expm1(-x) / x : 1;  // I0 / T
  const double spread =
      x > kSeries ? 1 / (x * x) - 1 / std::pow(2 * std::sinh(x / 2), 2) : 1.0 / 12 - x * x / 240;
  DecayInformation information;
  information.energy = rate_hz * signal_to_noise * signal_to_noise * mean * duration_s / 2;
  information.pole = information.energy * duration_s * duration_s * spread;
  return information;
}

double half_sine_impulse(double peak, double duration_s, double omega) {
  constexpr double kLimit = 1e-6;  // the quotient is pi / 4 at w tau = pi, to first order
  const double u = omega * duration_s / M_PI, below = 1 - u * u;
  const double quotient = std::abs(below) < kLimit ? M_PI / 4 : std::cos(M_PI * u / 2) / below;
  return 2 * peak * duration_s / M_PI * std::abs(quotient);
}

}  // namespace rigfit::ident
