// Free parameters of `update` from the words of its command line and of a file of candidates.
#pragma once

#include <string>
#include <vector>

#include "ident/update/problem/update_data.h"
#include "model/scene/scene.h"

namespace rigfit::apps {

/// "NAME", "NAME@each", "NAME=TARGET,TARGET,-TARGET", any with "@each" at its end. Throws
/// UsageError.
[[nodiscard]] ident::FreeParameter free_parameter(std::string text);

/// Of `--free` (empty: every member's EI, as what is least known of a rig), each with its
/// `--prior`, "NAME=VALUE,STD". Throws UsageError.
[[nodiscard]] std::vector<ident::FreeParameter> free_parameters(
    const std::vector<std::string>& free, const std::vector<std::string>& priors,
    const model::Scene& scene);

}  // namespace rigfit::apps
