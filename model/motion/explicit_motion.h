// Geometrically exact motion by an explicit, time-reversible scheme of effective order four.
//
// Every kick of the Stoermer-Verlet scheme takes the acceleration not at q but a little ahead,
//   v += h/2 a(p), q += h v, v += h/2 a(p),   p = q + h^2/12 a(q),
// a gradient-free form of Takahashi and Imada's modified potential (J. Phys. Soc. Japan 53 (1984)
// 3765; Wisdom, Holman and Touma 1996 for the processing). For an oscillator the trace of a step is
// 1 - x/2 + x^2/24, x = (omega h)^2: the cosine to order h^4, stable up to omega h = 2 sqrt(3)
// = 3.46 (Verlet: 2) with two evaluations a step. Frequencies err by (omega h)^4 / 1440 relative,
// so at the limit that the highest axial mode sets, transverse motions ten times slower are exact
// to 1e-6. The point p is also the processed (fourth-order) position, and a(p) its acceleration:
// the samples cost nothing more. Velocities are processed with the rate of a at q.
//
// Where only transverse motion matters that limit is far below the step its accuracy needs: axial
// waves can be slowed (node_mass.h) by kappa = h^2/8, which holds omega h below sqrt(8) whatever
// their speed. A wave of frequency omega then runs slow by (omega h)^2/16, relative; all else keeps
// the scheme's order.
//
// Forces enter as averages over a step that keep the impulse exact. Modal ratios act once in an
// interval T, in its middle: each mode's velocity decays by exp(-2 zeta omega T). The product of
// the factors is that of the motion itself, so amplitudes decay as they should whatever T;
// frequencies err by (zeta omega T)^2 / 6, relative. By Euler and Maclaurin's formula what lies
// between the sum of these kicks and the integral of the damping is, to first order in zeta, a part
// between -1/2 and 1/2 of a kick in the velocity, which samples take into account, and zeta (omega
// T)^2 / 12 and less in the displacement, which they do not; neither grows with time. Joint dampers
// are left to stiff_motion.h: C(q) changes with the motion, and those that overdamp waves are in
// balance with the elastic forces that they would be split from.
#pragma once

#include "model/algebra/numbers.h"
#include "model/motion/motion_problem.h"

namespace rigfit::model {

struct ExplicitOptions {
  SamplingOptions sampling;
  std::optional<double> step_s;  ///< largest step; else 3.2 over the highest frequency
  /// Slow axial waves as far as steps of this size need (s); zero: not at all. Where the chain
  /// turns too far from its members' chords for that, steps are smaller.
  double slowed_step_s = 0;
  /// Time between two actions of the dampers (s): the even number of steps below it, or two.
  double damper_interval_s = 0;
  /// Largest drift of the energy balance (EnergyBalance::drift): a step of the scheme's own choice
  /// is halved, up to four times, until the account closes that well.
  double drift = std::numeric_limits<double>::infinity();
};

/// kernel_supports(chain, 2 or 3) must hold for the motion, and no joint may have a damper. When
/// the energy grows without reason the step is halved, up to four times; then `completed` is false.
[[nodiscard]] MotionOutput explicit_motion(const MotionProblem& problem,
                                           const ExplicitOptions& options);

}  // namespace rigfit::model
