// Corrects a scene's cables: tensions by the load cell's calibration, lengths by the temperature.
//
//   T = scale * reading + zero     cables given by their tension
//   L0 = L (1 + alpha dT)          cables given by their length, or by the displacement of an end
//                                  (L is then the distance of the nodes less the displacement)
//   m0 = m (1 + strain)            mass per unstretched length of cables whose mass per length is
//                                  stated for the length as it hangs (`mass_of`)
//
// With a load cell shared by several states, scale and zero are common unknowns of a fit. T depends
// on neither temperature nor thermal expansion, since it was read in that state. Beams are not
// corrected.
#pragma once

#include "model/algebra/numbers.h"
#include "model/scene/scene.h"

namespace rigfit::model {

/// Whether the scene needs no correction.
[[nodiscard]] bool is_actual(const Scene& scene);
/// The scene with corrected tensions and lengths, load cell and temperature at their defaults.
/// Throws SceneError where a corrected tension is not positive.
[[nodiscard]] Scene actual_state(const Scene& scene);

/// From a member's first node to its second, m.
[[nodiscard]] Vector3d chord_of(const Scene& scene, const Member& member);

/// Strain of a cable as it hangs between its nodes, from its tension or length; zero for a beam.
[[nodiscard]] double installed_strain(const Scene& scene, const Member& member);

/// Largest strain above 0.5 % among cables that do not state `mass_of`, which is the relative error
/// of mass if the wrong length is assumed. Zero: there is none.
[[nodiscard]] double undecided_mass(const Scene& scene);

}  // namespace rigfit::model
