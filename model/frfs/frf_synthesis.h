// Frequency response functions of a scene, from any of its loads to any of its sensors, about the
// equilibrium: H = r (K + i omega C - omega^2 M)^-1 l, per newton at the load, from the
// damped equations at every line, without truncation of modes.
//
// Sign e^(+i omega t). Acceleration sensors give (m/s^2)/N (accelerance), velocity m/s/N,
// displacement m/N (receptance), force sensors N/N. Members with a modal damping ratio add
// C = sum_r 2 zeta_r omega_r (M phi_r)(M phi_r)' over the modes up to twice the highest line
// (Clough and Penzien, Dynamics of Structures, ch. 12; the inverse by Woodbury's formula), which
// is the damping of the modal response; higher modes have none.
//
// FRFs averaged under an exponential window exp(-a t) shared by force and response are the same
// function on the line s = i omega + a (signal/spectra/window.h): transforms of windowed signals
// are those of the signals at s. That holds without approximation for motions that start from rest
// within the block and have died out under the window at its end; a motion that has not adds each
// mode's residue times exp((p-s)T), where p is its pole and T the block.
//
// Derivatives by the scene's parameters, for fits to measured FRFs, include the change of the
// equilibrium. With D = K + s C + s^2 M, u = D^-1 l and v = D^-1 r (D is symmetric),
//   dH/dp = r_p' u + v' l_p - v' D_p u,
// so that one factorisation of D per line serves all parameters. K_p, M_p, C_p and the rows' rates
// carry the moved equilibrium (perturbed_equilibrium.h). Modal damping ratios are part of D; the
// derivatives of its modes are split into the part within the damped modes, where equal frequencies
// have a limit, and the rest (M. I. Friswell and S. Adhikari, AIAA Journal 38, 2000).
#pragma once

#include "model/algebra/numbers.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/scene.h"

namespace rigfit::model {

/// FRFs of a scene from its loads to its sensors.
struct SynthesizedFrfs {
  Equilibrium equilibrium;  ///< H is empty unless converged
  VectorXd frequency_hz;
  std::vector<MatrixXcd> H;  ///< per line: sensors x loads
};

/// Of `options`, segments, rotary inertia and torsion are used; "auto" members get the segments
/// that the scene's accuracy requires for the modes within the lines. Lines and the window's decay
/// rate must not be negative.
[[nodiscard]] SynthesizedFrfs synthesize_frfs(const Scene& scene, const VectorXd& frequency_hz,
                                              const ModesOptions& options = {},
                                              double decay_rate_1_s = 0);

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
