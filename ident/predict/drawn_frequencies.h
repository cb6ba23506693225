// Frequencies of the same modes in many scenes that differ in their parameters. For predictions,
// not for users.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "model/linear/modal_analysis.h"
#include "model/scene/scene.h"

namespace rigfit::ident {

/// Every member leaves its segments to the program.
[[nodiscard]] bool all_auto(const model::Scene& scene, const model::ModesOptions& options);

/// Frequencies (Hz), by scene, of the modes with the planes and orders of `reference`; a scene that
/// has no equilibrium, or lacks one of these modes, gets an empty vector. Scenes whose members all
/// leave their segments to the program are solved to `accuracy`.
[[nodiscard]] std::vector<Eigen::VectorXd> drawn_frequencies(
    std::span<const model::Scene> scenes, const std::vector<model::NaturalMode>& reference,
    const model::ModesOptions& options, double accuracy);

}  // namespace rigfit::ident
