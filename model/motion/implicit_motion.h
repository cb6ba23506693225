// Geometrically exact motion by an implicit scheme that keeps the energy: for stiff chains, long
// steps, torsion without inertia and anything else the explicit scheme does not take.
//
// The average vector field (Quispel and McLaren, J. Phys. A 41 (2008) 045206) along each step,
//   M (v1 - v0)/h = f - C qdot - int_0^1 dV/dq(q0 (+) s Delta) ds,   v0 + v1 = 2 Delta/h,
// gives V(q1) - V(q0) back exactly as work, so that without dampers kinetic and potential energy
// change into each other without loss whatever the step; the integral is taken by Gauss's rule
// (two points: the energy errs by h^4 of a third of the trapezoidal rule's constants, three: h^6).
// Second order in h: frequencies err by -(omega h)^2/12. Each step is solved by Newton's method
// with the banded tangent at its middle, factored once a step and again only when convergence
// slows.
#pragma once

#include <optional>

#include "model/motion/motion_problem.h"

namespace rigfit::model {

struct ImplicitOptions {
  SamplingOptions sampling;
  std::optional<double> step_s;  ///< largest step; else from `frequency_hz` and `accuracy`
  double frequency_hz = 0;       ///< highest frequency that is to be right within `accuracy`
  double accuracy = 1e-4;        ///< relative, of that frequency
  double tolerance = 1e-9;  ///< residual of a step, of the largest force; or what rounding leaves
  int points = 3;           ///< of Gauss's rule, 2 or 3
};

/// Steps that do not converge are halved, down to 1/64; then `completed` is false.
[[nodiscard]] MotionOutput implicit_motion(const MotionProblem& problem,
                                           const ImplicitOptions& options);

}  // namespace rigfit::model
