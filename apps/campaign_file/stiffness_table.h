// EI of a cable over its tension, as a table (tension_N, EI_Nm2 and, where known, std) from a
// bending test.
#pragma once

#include <filesystem>
#include <vector>

#include "apps/campaign_file/result_table.h"
#include "apps/cli/verb_context.h"

namespace rigfit::apps {

/// A table, or what `rigfit bending --json FILE` wrote (.json): its tests that gave an EI. Throws
/// model::SceneError.
[[nodiscard]] ResultTable read_stiffness_table(const std::filesystem::path& path);

/// Linear between the rows; beyond them the nearest row's, with a warning. Throws Refused for a
/// table without a complete row, model::SceneError for one without these columns.
[[nodiscard]] double stiffness_at(const ResultTable& table, double tension_N, VerbContext& context);

struct StiffnessPoint {
  double tension_N = 0, EI_Nm2 = 0;
  double std = 0;  ///< NaN: not known
};
/// The complete rows, by rising tension.
[[nodiscard]] std::vector<StiffnessPoint> stiffness_points(const ResultTable& table);

/// EI at a tension is (1 - share) of the first point's and share of the second's.
struct StiffnessShare {
  std::size_t first = 0, second = 0;
  double share = 0;
  double slope = 0;  ///< d EI / d tension, m2
};
[[nodiscard]] StiffnessShare stiffness_share(const std::vector<StiffnessPoint>& points,
                                             double tension_N);

}  // namespace rigfit::apps
