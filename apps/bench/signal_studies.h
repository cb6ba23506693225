// Speed against error of the estimators, on data whose truth is known in closed form: a free decay,
// hits on a sampled structure, frequency response functions of ten modes. The references have no
// error of their own.
#pragma once

#include <cstdint>

#include "apps/bench/bench_study.h"

namespace rigfit::apps {

/// Damping ratio of a 50 Hz decay of 1.7 % at 500 Hz in white noise 40 dB below, as in the
/// hanging-mass test; records of several lengths, rms over seeds.
[[nodiscard]] BenchStudy decay_study(std::uint64_t seed, const BenchBudget& budget);
/// Hits on a structure of ten modes, ten responses, 0.5 % noise.
[[nodiscard]] BenchStudy frf_study(std::uint64_t seed, const BenchBudget& budget);
/// Natural frequencies of ten modes (two of them 6 Hz apart at 315 Hz) from twenty functions with
/// 0.1 % noise.
[[nodiscard]] BenchStudy poles_study(std::uint64_t seed, const BenchBudget& budget);

}  // namespace rigfit::apps
