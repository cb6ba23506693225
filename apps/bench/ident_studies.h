// Speed against error of what is identified: EI from one bending slope, a cable's EI and tensions
// from its natural frequencies.
#pragma once

#include "apps/bench/bench_study.h"

namespace rigfit::apps {

/// EI from 4 P d / (Q l) over lambda from 0.3 to 25, which holds every test of the paper's rig.
[[nodiscard]] BenchStudy bending_study(const BenchBudget& budget);
/// EI and the tensions of a cable in two states from six natural frequencies in each, without
/// noise.
[[nodiscard]] BenchStudy update_study(const BenchBudget& budget);

}  // namespace rigfit::apps
