// Speed against error of a large motion in time: how it is integrated, and how finely the rig is
// cut.
//
// The "steps" study compares integrators on the same segments with the explicit scheme at a
// fraction of its step (its own error: against a step one and a half times as long, by its order);
// "segments" compares numbers of segments with many (own error: against two thirds as many).
// Sensors of acceleration and velocity are read as displacements: the accelerations of a cut string
// hold frequencies up to where the segments end.
#pragma once

#include <vector>

#include "apps/bench/bench_study.h"
#include "model/scene/scene.h"

namespace rigfit::apps {

/// The paper's cable at 200 N, 1 kg hung at its quarter span and cut at t = 0; 30 segments.
[[nodiscard]] model::Scene bench_released_cable();

/// Both studies; a scene whose loads are records is skipped with a reason.
[[nodiscard]] std::vector<BenchStudy> response_studies(const model::Scene& scene, double duration_s,
                                                       const BenchBudget& budget);

}  // namespace rigfit::apps
