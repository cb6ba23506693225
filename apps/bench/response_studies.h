// Speed against error of motion in time: how it is integrated, and how finely the rig is cut.
//
// "steps" studies compare integrators on the same segments with the own explicit scheme at a
// fraction of its step (its own error: against a step one and a half times as long, by its order),
// in the linear task with the exact modal recurrence at four times the rate;
// "segments" studies compare numbers of segments with many (own error: against two thirds as many).
// Sensors of acceleration and velocity are read as displacements: the accelerations of a cut string
// hold frequencies up to where the segments end.
#pragma once

#include <vector>

#include "apps/bench/bench_study.h"
#include "model/scene/force_history.h"
#include "model/scene/scene.h"

namespace rigfit::apps {

struct ResponseStudyOptions {
  double duration_s = 2;
  double rate_hz = 2000;
  std::vector<model::ForceHistory> records;  ///< by load of the scene; used for kind `record`
};

/// Loads as they are.
[[nodiscard]] std::vector<BenchStudy> nonlinear_response_studies(
    const model::Scene& scene, const ResponseStudyOptions& options, const BenchBudget& budget);
/// Loads so small that no frequency shifts by more than 1e-12.
[[nodiscard]] std::vector<BenchStudy> linear_response_studies(const model::Scene& scene,
                                                              const ResponseStudyOptions& options,
                                                              const BenchBudget& budget);

}  // namespace rigfit::apps
