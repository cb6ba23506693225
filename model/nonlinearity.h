// How far a motion is from linear: the shift of natural frequencies in its most deflected state,
// estimated from the linear answer before anything non-linear is computed.
//
// At the instant t* of greatest strain energy sum omega^2 q^2 / 2 the linear answer's elastic
// forces K u are put on the geometrically exact chain at rest; where it then settles (a stiff cable
// does not stretch as the linear shape would have it, it pulls), its tangent has the frequencies
// that the motion meets at its extremes. The shift is their relative change, weighted by each
// mode's share of the energy.
#pragma once

#include "model/linear_answer.h"
#include "model/loaded_state.h"
#include "model/modes.h"

namespace rigfit::model {

struct Nonlinearity {
  double time_s = 0;                ///< of the most deflected state
  double frequency_shift = 0;       ///< relative; 1 when no deflected equilibrium was found
  double frequency_at_rest_hz = 0;  ///< of the mode with most of the energy among the lowest
  double frequency_deflected_hz = 0;
  double upper_frequency_hz = 0;  ///< modes up to here hold 99 % of the energy
  double energy_J = 0;            ///< strain energy of the linear answer there
};

/// `assembly`: of the motion that the loads drive (in_plane or space).
[[nodiscard]] Nonlinearity estimate_nonlinearity(const ChainModes& modes,
                                                 const LinearAnswer& answer, const Scene& scene,
                                                 const std::vector<const ForceHistory*>& records,
                                                 double duration_s, const Assembly& assembly);

}  // namespace rigfit::model
