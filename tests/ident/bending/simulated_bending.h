// Bending tests simulated without the estimator's assumptions: end springs in closed form, six laws
// for wire friction by their differential equations, a tension that grows, readings with noise,
// resolution, drift and spikes.
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

enum class Friction { none, bilinear, dahl_half, dahl, dahl_two, bouc_wen };

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
  double load_resolution_N = 0, deflection_resolution_m = 0;
  double drift = 0;  ///< load cell's drift over the record, relative to the largest load
  int deflection_spikes = 0, load_spikes = 0;
  double spike = 3;      ///< height, in largest values
  double toe = 0;        ///< share of the travel over which only a fifth of the stiffness acts
  double curvature = 0;  ///< relative change of the slope over the travel
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

inline double rate(Friction law, double z, double sign) {
  const double u = std::max(0.0, 1 - sign * z);
  switch (law) {
    case Friction::none:
      return 0;
    case Friction::bilinear:
      return u > 0 ? 1 : 0;
    case Friction::dahl_half:
      return std::sqrt(u);
    case Friction::dahl:
      return u;
    case Friction::dahl_two:
      return u * u;
    case Friction::bouc_wen:  // n = 2, beta = gamma = 1/2
      return 1 - 0.5 * (1 + (sign * z > 0 ? 1 : -1)) * z * z;
  }
  return 0;
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
    constexpr int kSteps = 200;  // steps of the friction's equation between readings
    double d = 0;
    for (int s = 1; s <= kSteps; ++s) {
      const double at = share_before + (share - share_before) * s / kSteps;
      const double phase = std::fmod(at, 2.0);
      d = test.travel_m * (phase <= 1 ? phase : 2 - phase);
      const double step = d - before;
      if (test.friction != Friction::none && step != 0) {
        const double sign = step > 0 ? 1 : -1;
        z += step / test.friction_travel_m * rate(test.friction, z, sign);
        z = std::clamp(z, -1.0, 1.0);
      }
      before = d;
    }
    share_before = share;
    const double P = test.tension_N + test.frame_N_m * 2 * d * d / test.span_m;
    const double knee = test.toe * test.travel_m;
    const double felt = d < knee ? 0.2 * d : d - 0.8 * knee;
    const double bent = felt * (1 + 0.5 * test.curvature * felt / test.travel_m);
    const double Q = bent / compliance(test.EI_Nm2, P, test.span_m, test.clamp_Nm_rad) +
                     test.friction_N * z + test.drift * peak * i / n;
    const auto read = [&](double value, double noise, double resolution) {
      value += noise * normal(random);
      return resolution > 0 ? resolution * std::round(value / resolution) : value;
    };
    out.tension_N[i] = P;
    out.load_N[i] = read(Q, test.load_noise * peak, test.load_resolution_N);
    out.deflection_m[i] =
        read(d, test.deflection_noise * test.travel_m, test.deflection_resolution_m);
  }
  std::uniform_int_distribution<int> row(1, n - 2);
  for (int k = 0; k < test.deflection_spikes; ++k) {
    out.deflection_m[row(random)] += test.spike * test.travel_m * (k % 2 == 0 ? 1 : -1);
  }
  for (int k = 0; k < test.load_spikes; ++k) {
    out.load_N[row(random)] += test.spike * peak * (k % 2 == 0 ? 1 : -1);
  }
  return out;
}

}  // namespace rigfit::ident::simulated
