// Axial stiffness of a cable from the undamped frequency of a mass that hangs on it.
//
// The cable is an elastic rod with its own mass m L under a frame kf, above an adapter km (both
// massless springs) and the mass M. With W = omega^2, x^2 = W m L / kc and kc = EA / L:
//   W M = K,   1/K = 1/km + (T + r) / (kc (1 - x^2 T r)),   T = tan(x) / x,   r = kc / kf
// (Meirovitch, Fundamentals of Vibrations, sec. 8.3). For rigid frame and adapter this is
// kc = W (M + m L / 3) to first order in m L / M.
#pragma once

#include <cmath>

namespace rigfit::ident {

/// 1/K without the adapter: what gives way under the mass, from the rod's static stiffness kc, its
/// inertia W m L and the compliance above it. Scalar: double or ceres::Jet.
template <class T>
T rod_compliance(const T& kc, const T& inertia, const T& above) {
  using std::sqrt, std::tan;
  const T q = inertia / kc;
  T t = 1.0 + q / 3.0 + q * q * (2.0 / 15);  // next term below 1e-13 where q < 1e-4
  if (!(q < 1e-4)) {
    const T x = sqrt(q);
    t = tan(x) / x;
  }
  const T r = kc * above;
  return (t + r) / (kc * (1.0 - q * t * r));
}

struct RodOnMass {
  double omega_squared = 0;         ///< undamped oscillation, 1/s^2
  double mass_kg = 0;               ///< M
  double mass_per_length_kg_m = 0;  ///< m; 0: massless
  double length_m = 0;
  double adapter_N_m = 0;  ///< km; 0: rigid
  double frame_N_m = 0;    ///< kf; 0: rigid
};

struct RodStiffness {
  /// kc; NaN when adapter and frame are together softer than what was measured.
  double cable_N_m = 0;
  double series_N_m = 0;                       ///< static, adapter and frame included
  double by_omega_squared = 0, by_length = 0;  ///< d ln kc / d ln input
  double misfit_by_omega_squared = 0;          ///< d ln(W M / K) / d ln W, where kc stays
};

/// Solved to rounding by Brent's method (GSL) on the frequency equation without its poles.
[[nodiscard]] RodStiffness rod_stiffness(const RodOnMass& rod);

}  // namespace rigfit::ident
