// Derivatives of a scene's frequency response functions by its parameters, the change of the
// equilibrium included, for fits to measured FRFs.
//
// With D = K + s C + s^2 M, s = i omega + a (frf_synthesis.h), u = D^-1 l and v = D^-1 r (D is
// symmetric),
//   dH/dp = r_p' u + v' l_p - v' D_p u,
// so that one factorisation of D per line serves all parameters. K_p, M_p, C_p and the rows' rates
// carry the moved equilibrium (perturbed_equilibrium.h). Modal damping ratios are part of D
// (frf_synthesis.h); the derivatives of its modes are split into the part within the damped
// modes, where equal frequencies have a limit, and the rest (M. I. Friswell and S. Adhikari, AIAA
// Journal 38, 2000).
#pragma once

#include "model/algebra/numbers.h"
#include "model/frfs/frf_synthesis.h"

namespace rigfit::model {

/// FRFs and their derivatives by the given parameters.
struct FrfSensitivities {
  SynthesizedFrfs frfs;  ///< as from `synthesize_frfs`; H empty without an equilibrium
  /// By parameter, then line: sensors x loads, unit of H per unit of the parameter. Empty like H.
  std::vector<std::vector<MatrixXcd>> rate;
};

/// Lines must not be negative. Of `options`, segments, rotary inertia and torsion are used. For a
/// node moved out of the plane of symmetry the derivative comes from differences of FRFs.
[[nodiscard]] FrfSensitivities synthesize_frf_sensitivities(
    const Scene& scene, const VectorXd& frequency_hz,
    const std::vector<ParameterAccess>& parameters, const ModesOptions& options = {},
    double decay_rate_1_s = 0);

}  // namespace rigfit::model
