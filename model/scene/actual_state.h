// A scene's cables as they are: tensions by the load cell's calibration, lengths at the scene's
// temperature.
//
//   T = scale * reading + zero     cables given by their tension
//   L0 = L (1 + alpha dT)          cables given by their length, or by the displacement of an end
//                                  (L is then the distance of the nodes less the displacement)
//   m0 = m (1 + strain)            mass per unstretched length of cables whose mass per length is
//                                  stated for the length as it hangs (`mass_of`)
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

/// Strain of a cable as it hangs, between its nodes, by its tension or length; zero of a beam.
[[nodiscard]] double installed_strain(const Scene& scene, const Member& member);

/// Largest strain above 0.5 % of a cable that does not say what its mass per length is of: what its
/// mass would be off by. Zero: none.
[[nodiscard]] double undecided_mass(const Scene& scene);

}  // namespace rigfit::model
