// Geometrically exact motion by backward differentiation formulas of order one to five: for joint
// dampers, torsion, nodes that turn in space; with a tight tolerance the reference that the
// explicit scheme is measured against.
//
// SUNDIALS' IDA (A. C. Hindmarsh et al., ACM Trans. Math. Softw. 31 (2005) 363-396) on
//   u - v = 0                                        of the unknowns with inertia,
//   M v' + C(q) w + D w + dV/dq - f = 0              of all; w = v, without inertia w = u.
// q are increments of a state (Assembly::advance) and u = T(q) q' their rates there: angles about
// tangents and nodes' angular velocities, which differ from the coordinates' own rates once the
// chain has turned. Newton's method solves (cj^2 M + cj C + K) dq = r in envelope storage, T taken
// as one and D left out of the matrix. Turned by half a radian, and where a force jumps, the chain
// takes increments from its new state, which restarts the formulas.
//
// The formulas damp what a step does not resolve; the energy balance shows by how much.
#pragma once

#include "model/motion/motion_problem.h"

namespace rigfit::model {

struct StiffOptions {
  SamplingOptions sampling;
  double relative_tolerance = 1e-6;  ///< tolerance of a step's local error
  double displacement_m = 1e-3;      ///< size of the motion: what the tolerance is of where an
                                     ///< unknown is small; for angles (rad) over the segment
  double velocity_m_s = 1;
};

[[nodiscard]] MotionOutput stiff_motion(const MotionProblem& problem, const StiffOptions& options);

}  // namespace rigfit::model
