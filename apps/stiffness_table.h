// EI of a cable over its tension, as a table (tension_N, EI_Nm2) from a bending test.
#pragma once

#include <filesystem>

#include "apps/result_table.h"
#include "apps/verb_context.h"

namespace rigfit::apps {

/// Linear between the rows; beyond them the nearest row's, with a warning. Throws Refused for a
/// table without a complete row, model::SceneError for one without these columns.
[[nodiscard]] double stiffness_at(const ResultTable& table, double tension_N, VerbContext& context);

}  // namespace rigfit::apps
