// Modes of a chain as a user sees them: plane, family, damping ratio, shape by member, values at
// the scene's sensors and loads.
//
// A mode is of a plane or a family when at least 0.9 of its kinetic energy is; twist and motion
// along the members count from 0.5.
#pragma once

#include <vector>

#include "model/linear/modes.h"
#include "model/linear/natural_mode.h"

namespace rigfit::model {

/// In the order of ChainModes::order; `options` says whether damping ratios and shapes are wanted.
[[nodiscard]] std::vector<NaturalMode> natural_modes(const ResolvedModes& resolved,
                                                     const Scene& scene,
                                                     const ModesOptions& options);
}  // namespace rigfit::model
