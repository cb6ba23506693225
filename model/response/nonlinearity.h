// How far a motion is from linear: the shift of natural frequencies in its most deflected state,
// estimated from the linear answer before anything non-linear is computed.
//
// At the instant t* of greatest strain energy sum omega^2 q^2 / 2 the linear answer's elastic
// forces K u are put on the geometrically exact chain at rest, and once more with the other sign;
// where it settles (a stiff cable does not stretch as the linear shape would have it, it pulls),
// its tangent has the eigenvalues lambda+ and lambda- that the motion meets at its extremes. For
// one mode with V = w^2 q^2/2 + b q^3/3 + c q^4/4 perturbation theory (A. H. Nayfeh and D. T. Mook,
// Nonlinear Oscillations, 1979, section 2.3) gives the frequency of the motion itself,
//   w_m/w - 1 = 3 c q^2/(8 w^2) - 5 b^2 q^2/(12 w^4)
//             = ((lambda+ + lambda-)/(2 w^2) - 1)/8 - 5/48 ((lambda+ - lambda-)/(2 w^2))^2;
// the shift is the sum of both terms' sizes, weighted by each mode's share of the energy.
#pragma once

#include "model/linear/modes.h"
#include "model/response/linear_answer.h"
#include "model/statics/equilibrium.h"

namespace rigfit::model {

struct Nonlinearity {
  double frequency_shift = 0;  ///< relative; 1 when no deflected equilibrium was found
  /// Frequency of the mode with most of the energy among the lowest.
  double frequency_at_rest_hz = 0;
  double frequency_moving_hz = 0;  ///< its estimate in motion
  double upper_frequency_hz = 0;   ///< modes up to here hold 99 % of the energy
  double energy_J = 0;             ///< strain energy of the linear answer there
};

/// `assembly`: of the motion that the loads drive (in_plane or space).
[[nodiscard]] Nonlinearity estimate_nonlinearity(const ChainModes& modes,
                                                 const LinearAnswer& answer, const Scene& scene,
                                                 const std::vector<const ForceHistory*>& records,
                                                 double duration_s, const Assembly& assembly);

}  // namespace rigfit::model
