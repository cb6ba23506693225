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

/// Of each scene the frequencies (Hz) of the modes that have the plane and order of `reference`'s;
/// empty where there is no equilibrium or one of them is not found. Scenes whose members all leave
/// their segments to the program are solved to `accuracy`.
[[nodiscard]] std::vector<Eigen::VectorXd> drawn_frequencies(
    std::span<const model::Scene> scenes, const std::vector<model::NaturalMode>& reference,
    const model::ModesOptions& options, double accuracy);

}  // namespace rigfit::ident
