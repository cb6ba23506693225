// Writes a scene's cables as an input file of MoorDyn (version 2): line types, points, lines,
// options.
//
// MoorDyn's z is the scene's y, its y the scene's -z; there is no water. A line's unstretched
// length is the equilibrium's; its bending stiffness acts between segments but not at its ends,
// which are pinned. A member's damping ratio z becomes the axial damping that gives the first axial
// mode, omega = pi / L sqrt(EA / m), that ratio: BA = 2 z EA / omega; an axial joint damper is BA
// itself.
#pragma once

#include "model/algebra/numbers.h"
#include "model/scene/scene.h"
#include "model/statics/equilibrium_result.h"

namespace rigfit::model {

struct MoordynInput {
  std::string text;
  std::vector<std::string> notes;  ///< differences between file and scene
};

/// `equilibrium` is the converged one of the same scene. Throws SceneError for what cannot be
/// exported: beams, springs at supports, tapered cables, gravity that is not along -y.
[[nodiscard]] MoordynInput moordyn_input(const Scene& scene, const Equilibrium& equilibrium);

}  // namespace rigfit::model
