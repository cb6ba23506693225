// Bending tests simulated without the estimator's assumptions: end springs in closed form, two laws
// for wire friction by their differential equations, a tension that grows, readings with noise and
// spikes.
//
// End springs of rotational stiffness k (each), lambda = sqrt(P l^2 / (4 EI)), c = k l / (2 EI
// lambda), the tensioned beam w'''' EI - P w'' = 0 with EI w'' = k w' at the ends gives
//   4 P d / (Q l) = 1 - (2 c (cosh lambda - 1) + sinh lambda) / (lambda (c sinh lambda + cosh
//   lambda))
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "ident/bending/bending_analysis.h"

namespace rigfit::ident::simulated {

enum class Friction { none, bilinear, dahl };

struct Bending {
  double EI_Nm2 = 0.5, tension_N = 100, span_m = 0.5;
  double clamp_Nm_rad = std::numeric_limits<double>::infinity();
  double frame_N_m = 2e4;  ///< tension gained by shortening
  double travel_m = 1e-3;  ///< largest deflection
  int rows = 200;          ///< all together
  int strokes = 4;         ///< 1: loading only
  Friction friction = Friction::none;
  double friction_N = 0, friction_travel_m = 1e-4;
  double load_noise = 0, deflection_noise = 0;  ///< relative to the largest value
  int deflection_spikes = 0, load_spikes = 0;
};

inline double compliance(double EI, double P, double l, double k) {
  const double lambda = std::sqrt(P * l * l / (4 * EI));
  const double F =
      std::isfinite(k)
          ? [&] {
              const double c = k * l / (2 * EI * lambda);
              return 1 - (2 * c * (std::cosh(lambda) - 1) + std::sinh(lambda)) /
                             (lambda * (c * std::sinh(lambda) + std::cosh(lambda)));
            }()
          : 1 - 2 * std::tanh(lambda / 2) / lambda;
  return F * l / (4 * P);
}

inline BendingRecord record(const Bending& test, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const int n = test.rows;
  BendingRecord out;
  out.tension_N.resize(n), out.load_N.resize(n), out.deflection_m.resize(n);
  const double peak =
      test.travel_m / compliance(test.EI_Nm2, test.tension_N, test.span_m, test.clamp_Nm_rad);
  double z = 0, before = 0, share_before = 0;
  for (int i = 0; i < n; ++i) {
    const double share = static_cast<double>(i) / (n - 1) * test.strokes;
    // Steps of the friction's equation between readings.
    const int steps = test.friction == Friction::none ? 1 : 200;
    double d = 0;
    for (int s = 1; s <= steps; ++s) {
      const double at = share_before + (share - share_before) * s / steps;
      const double phase = std::fmod(at, 2.0);
      d = test.travel_m * (phase <= 1 ? phase : 2 - phase);
      const double step = d - before;
      if (test.friction != Friction::none && step != 0) {
        const double sign = step > 0 ? 1 : -1;
        const double rest = std::max(0.0, 1 - sign * z);
        const double rate = test.friction == Friction::dahl ? rest : rest > 0 ? 1 : 0;
        z += step / test.friction_travel_m * rate;
        z = std::clamp(z, -1.0, 1.0);
      }
      before = d;
    }
    share_before = share;
    const double P = test.tension_N + test.frame_N_m * 2 * d * d / test.span_m;
    const double Q =
        d / compliance(test.EI_Nm2, P, test.span_m, test.clamp_Nm_rad) + test.friction_N * z;
    out.tension_N[i] = P;
    out.load_N[i] = Q + test.load_noise * peak * normal(random);
    out.deflection_m[i] = d + test.deflection_noise * test.travel_m * normal(random);
  }
  constexpr double kSpike = 3;  // height, in largest values
  std::uniform_int_distribution<int> row(1, n - 2);
  for (int k = 0; k < test.deflection_spikes; ++k) {
    out.deflection_m[row(random)] += kSpike * test.travel_m * (k % 2 == 0 ? 1 : -1);
  }
  for (int k = 0; k < test.load_spikes; ++k) {
    out.load_N[row(random)] += kSpike * peak * (k % 2 == 0 ? 1 : -1);
  }
  return out;
}

}  // namespace rigfit::ident::simulated
