// The same equations of motion by SUNDIALS' CVODE: the references that the project's own
// integrators are measured against.
//
// Adams formulas of order 1 to 12 with fixed-point iteration are the paper's method (20-sim's
// "Vode Adams"): its step stays below the highest axial mode's period. Backward differentiation
// formulas with Newton's method solve (M + gamma C + gamma^2 K) x = r exactly in banded storage
// (mass, damping and tangent of the chain's assembly) and take any step that the accuracy allows.
// A. C. Hindmarsh et al., ACM Trans. Math. Softw. 31 (2005) 363-396.
#pragma once

#include "model/motion/motion_problem.h"

namespace rigfit::model {

enum class CvodeMethod { adams_fixed_point, bdf_banded };

struct CvodeOptions {
  SamplingOptions sampling;
  CvodeMethod method = CvodeMethod::adams_fixed_point;
  double relative_tolerance = 1e-6;
  double absolute_displacement_m = 1e-9;
  double absolute_velocity_m_s = 1e-6;
  long max_steps = 50'000'000;  ///< over the whole response
};

/// As explicit_motion: kernel_supports(chain, 2 or 3) must hold for the motion.
[[nodiscard]] MotionOutput cvode_response(const MotionProblem& problem,
                                          const CvodeOptions& options);

}  // namespace rigfit::model
