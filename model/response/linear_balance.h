// The energy balance of a linear answer over time: sum (q'^2 + omega^2 q^2) / 2 against what loads
// supplied, int f v dt, and what dampers took, int q' D q' dt, each integrated on its own: in
// closed form while no force acts,
//   int Re(w e^{st})^2 dt = Re( |w|^2 e^{2 Re(s) t} / (2 Re s) + w^2 e^{2st} / (2s) ) / 2,
// by Gauss's rule (five points) between the corners of forces.
#pragma once

#include "model/motion/sampling.h"
#include "model/response/linear_answer.h"

namespace rigfit::model {

/// Instants as `sampling` says. Of a truncated answer: of the modes that are in it.
[[nodiscard]] EnergyBalance linear_balance(const LinearAnswer& answer, const Scene& scene,
                                           const std::vector<const ForceHistory*>& records,
                                           const SamplingOptions& sampling);

}  // namespace rigfit::model
