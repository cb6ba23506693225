// Speed against error of what the model does without time: statics, modes, frequency response
// functions.
//
// References: three fine chains of every member and the limit for vanishing segments
// (bench_study.h, `extrapolated`); their own error is the change against the limit from chains two
// thirds as fine.
#pragma once

#include "apps/bench/bench_study.h"
#include "model/scene/scene.h"

namespace rigfit::apps {

/// Positions at members' middles at rest.
[[nodiscard]] BenchStudy statics_study(const model::Scene& scene, const BenchBudget& budget);
/// The first six natural frequencies.
[[nodiscard]] BenchStudy modes_study(const model::Scene& scene, const BenchBudget& budget);
/// All loads to all sensors at lines up to the sixth natural frequency and a quarter beyond.
[[nodiscard]] BenchStudy frf_synthesis_study(const model::Scene& scene, const BenchBudget& budget);

/// Mean number of segments of a member.
[[nodiscard]] int mean_segments(const std::vector<int>& by_member);
/// The scene with so many segments in every member; 0: "auto".
[[nodiscard]] model::Scene with_segments(model::Scene scene, int segments);

}  // namespace rigfit::apps
