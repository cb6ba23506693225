// CalculiX (ccx) beside the segment model: natural frequencies of the same scene by quadratic beam
// elements, where the program is installed. Nothing is fetched.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "apps/bench/bench_study.h"
#include "model/scene/scene.h"

namespace rigfit::apps {

struct CalculixRows {
  std::vector<BenchRow> rows;  ///< by rising number of elements a member
  std::string note;            ///< why there are none, or how far its limit is from ours
};

/// Runs of the scene's deck (model/export/write_calculix.h) with rising numbers of elements. Errors
/// are against its own run of twice the finest, of the modes nearest to `frequency_hz` (rising,
/// Hz): the deck is a slightly different rig. Times are of the whole run.
[[nodiscard]] CalculixRows calculix_rows(const model::Scene& scene,
                                         const Eigen::VectorXd& frequency_hz,
                                         const BenchBudget& budget);

}  // namespace rigfit::apps
