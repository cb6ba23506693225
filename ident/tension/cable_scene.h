// A cable as a scene of two nodes and one member, and what follows from its description alone.
#pragma once

#include "ident/tension/tension_result.h"
#include "model/scene/scene.h"

namespace rigfit::ident {

/// Strain at the tension that is assumed where no EA is given (a steel cable at a third of its
/// strength), and the std of its logarithm: within a factor of 2 or so.
inline constexpr double kAssumedStrain = 1e-3, kAssumedStrainStd = 0.5;

/// EA as given or assumed, at a tension.
[[nodiscard]] double axial_rigidity(const CableDescription& cable, double tension_N);

/// Weight per length across the chord, N/m.
[[nodiscard]] double weight_across(const CableDescription& cable);

/// Irvine's parameter (w L / T)^2 EA L / (T Le), w the weight per length across the chord and
/// Le = L (1 + (w L / T)^2 / 8). Source: T. M. Irvine, Cable Structures, 1981, ch. 3.
[[nodiscard]] double irvine_parameter(const CableDescription& cable, double tension_N);

/// Nodes "start" and "end", member "cable" of "auto" segments; springs start at 10 EI / length.
[[nodiscard]] model::Scene cable_scene(const CableDescription& cable, CableEnds ends,
                                       double tension_N, double EI_Nm2);

/// Tension of the scene's member, its horizontal component but for steep cables, over that at
/// mid-span.
[[nodiscard]] double scene_tension_factor(const CableDescription& cable);

}  // namespace rigfit::ident
