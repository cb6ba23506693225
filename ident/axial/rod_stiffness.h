// Axial stiffness of a cable from the undamped frequency of a mass that hangs on it.
//
// The cable is an elastic rod with its own mass mc = m L, fixed above, a massless adapter km in
// series below it, then the mass M. What the mass sees at omega is
//   omega^2 M = k(omega),   1/k(omega) = 1/km + 1/kr,   kr = kc x cot x,   x = omega sqrt(mc / kc)
// (Meirovitch, Fundamentals of Vibrations, sec. 8.3), so kr follows from omega and M, and
//   x tan x = omega^2 mc / kr,   kc = omega^2 mc / x^2
// gives the static stiffness kc = EA / L without approximation. To first order in mc / M it is the
// usual omega^2 (M + mc / 3) for a rigid adapter (exact to (mc / M)^2 / 45); behind an adapter only
// the rod's share of the motion counts, omega^2 (M + (mc / 3) (1 - k / km)^2).
//
// Under a frame that gives way by kf at the rod's upper end,
//   1/kr = (T + r) / (kc (1 - x^2 T r)),   T = tan(x) / x,   r = kc / kf,
// which is solved for kc by bisection.
#pragma once

namespace rigfit::ident {

struct RodOnMass {
  double omega_squared = 0;         ///< of the undamped oscillation, 1/s^2
  double mass_kg = 0;               ///< M
  double mass_per_length_kg_m = 0;  ///< m; 0: massless
  double length_m = 0;
  double adapter_N_m = 0;  ///< km; 0: rigid
  double frame_N_m = 0;    ///< kf; 0: rigid
};

struct RodStiffness {
  /// kc; NaN when adapter and frame are together softer than what was measured.
  double cable_N_m = 0;
  double series_N_m = 0;  ///< static, adapter and frame included
  /// d ln kc / d ln input.
  double by_omega_squared = 0, by_mass = 0, by_mass_per_length = 0, by_length = 0, by_adapter = 0;
};

[[nodiscard]] RodStiffness rod_stiffness(const RodOnMass& rod);

}  // namespace rigfit::ident
