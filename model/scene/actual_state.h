// A scene's cables as they are: tensions by the load cell's calibration, lengths at the scene's
// temperature.
//
//   T = scale * reading + zero        of every cable that is given by its tension
//   L0 = L (1 + alpha dT)             of every cable that is given by its length, or by the
//   displacement
//                                     of its end (then L is the distance of its nodes less the
//                                     displacement)
//
// A load cell that several states share makes scale and zero common unknowns of a fit; T depends on
// neither temperature nor thermal expansion, since it was read in the state. Beams are drawn as
// they are.
#pragma once

#include "model/scene/scene.h"

namespace rigfit::model {

/// Whether the scene's own numbers are those of its state: nothing to correct.
[[nodiscard]] bool is_actual(const Scene& scene);
/// The scene with corrected tensions and lengths, load cell and temperature at their defaults.
/// Throws SceneError where a corrected tension is not positive.
[[nodiscard]] Scene actual_state(const Scene& scene);

}  // namespace rigfit::model
