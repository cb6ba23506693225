// Writes a scene as an input deck of CalculiX (ccx), an independent finite-element program:
// quadratic beam elements, prestress and sag by a non-linear static step, then natural frequencies
// about that state.
//
// Every member becomes a bar of rectangular section with the member's EA and EI: h = sqrt(12 EI/EA)
// in each direction, E = EA/(b h), density from its mass (the rectangular form of Jalali and
// Rideout 2021, eq. (16), chosen because ccx integrates a rectangle exactly and a circle only
// nearly). Torsion follows from that section and Poisson's ratio, not from the scene's GJ. A cable
// starts straight between its nodes; a thermal strain gives it its unstretched length. For a
// thermal strain a, ccx 2.20 subtracts a - a^2/2 from Green's strain (found from strings at
// tensions from 0.005 to 0.08 EA, to 2e-5 of the tension); a is chosen so that the force at rest is
// the scene's. The axial stiffness about rest is then 1 + 1.5 e times the scene's, with e the
// strain at rest. A cable is first cooled to a tight state, from which the sagging one is reached
// without passing through slack. Its pinned ends are left free to twist: ccx turns a node with a
// held rotation into a rigid body, and once such an end has turned by the sag's slope, holding one
// component resists the others as well (frequencies of the 25 N cable rise by 0.12 % when its modes
// are even, 0.35 % when odd). This adds a spinning mode that the scene does not have.
#pragma once

#include <string_view>
#include <tuple>

#include "document/describe.h"
#include "model/algebra/numbers.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/scene.h"

namespace rigfit::model {

/// Size of the deck.
struct CalculixOptions {
  int elements_per_member = 40;  ///< B32R, three nodes each
  int frequencies = 12;
  double poisson_ratio = 0.3;
};

/// A member at rest in the deck.
struct CalculixMember {
  std::string name;
  double tension_N = 0;              ///< tension in the deck, where the cable lies as in the scene
  double scene_tension_N = 0;        ///< axial force at rest, a cable's horizontal one
  double axial_stiffness_ratio = 1;  ///< about rest, deck's over scene's

  static constexpr std::string_view title = "at rest";
  static constexpr auto fields() {
    using T = CalculixMember;
    using describe::field;
    return std::tuple{
        field("member", &T::name, "", "member", ""),
        field("deck_tension_N", &T::tension_N, "N", "tension in the deck", ""),
        field("scene_tension_N", &T::scene_tension_N, "N", "in the scene", "a cable's horizontal"),
        field("axial_stiffness_ratio", &T::axial_stiffness_ratio, "", "axial stiffness ratio",
              "about rest")};
  }
};

/// An input deck and what it leaves out.
struct CalculixDeck {
  std::string text;
  std::vector<CalculixMember> members;
  std::vector<std::string> notes;  ///< differences between deck and scene
};

/// `equilibrium` (converged, of the same scene) gives each cable's unstretched length. Throws
/// SceneError for features that cannot be exported: EI = 0, taper, rotational springs, released
/// joints.
[[nodiscard]] CalculixDeck calculix_deck(const Scene& scene, const Equilibrium& equilibrium,
                                         const CalculixOptions& options = {});

}  // namespace rigfit::model
