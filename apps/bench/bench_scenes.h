// The scenes of the standard run: the paper's cable at 200 N and its cable-beam rig, as they lie in
// testdata/jalali2021/scenes.
#pragma once

#include "model/scene/scene.h"

namespace rigfit::apps {

/// With a hammer at the quarter span.
[[nodiscard]] model::Scene bench_cable();
/// 1 kg hung at its quarter span, cut at t = 0; 30 segments.
[[nodiscard]] model::Scene bench_released_cable();
[[nodiscard]] model::Scene bench_rig();

}  // namespace rigfit::apps
