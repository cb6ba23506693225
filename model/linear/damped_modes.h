// Damped modes of a chain: (s^2 M + s C + K) u = 0 with the joint dampers' C of any distribution,
// so complex shapes and frequencies; or the members' modal damping ratios.
//
// Each undamped mode is followed to its damped one: the quadratic problem in the space of the modes
// asked for gives the start, inverse iteration with the complex symmetric matrix s^2 M + s C + K
// and the Rayleigh functional (P. Lancaster, Lambda-matrices and Vibrating Systems, 1966, ch. 6)
// the rest, to rounding. Members with a modal ratio add sum_m zeta_m E_m / sum_m E_m, weighted by
// their part of the strain energy; both kinds may be in one scene.
#pragma once

#include "model/algebra/numbers.h"
#include "model/linear/modes.h"

namespace rigfit::model {

/// By undamped mode of the motion: s = -zeta omega + i omega sqrt(1 - zeta^2), 1/s. Overdamped
/// modes have an imaginary part of zero; their pair's slower root is given.
[[nodiscard]] VectorXcd damped_poles(const MotionModes& motion, const ChainState& state,
                                     const Scene& scene);

/// Modal damping ratios from the members' `damping_ratio` alone.
[[nodiscard]] VectorXd modal_ratios(const Assembly& assembly, const MatrixXd& shapes,
                                    const ChainState& state, const Scene& scene);
[[nodiscard]] bool has_joint_dampers(const Scene& scene);

/// |s| and zeta = -Re s / |s| of a pole.
[[nodiscard]] double damping_ratio_of(Complex pole);

}  // namespace rigfit::model
