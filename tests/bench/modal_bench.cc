// Times of the poles of order 60 and of the whole identification. The truth table (modal_truth)
// prints their accuracy.
#include <benchmark/benchmark.h>

#include <cmath>
#include <complex>
#include <random>

#include "signal/modal/modal_identification.h"
#include "signal/poles/lscf.h"
#include "tests/reference/defective_frfs.h"
#include "tests/reference/ten_mode_truth.h"

namespace rigfit {
namespace {

signal::FrfSet noisy_frfs(Eigen::Index responses, Eigen::Index lines) {
  const auto truth = testing::ten_mode_truth(responses);
  const double step = 1400.0 / static_cast<double>(lines);
  signal::FrfSet set = truth.frfs(Eigen::VectorXd::LinSpaced(lines, step, 1400));
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const double scale = 1e-3 * set.H.norm() / std::sqrt(static_cast<double>(set.H.size()));
  for (auto& h : set.H.reshaped())
    h += scale * std::complex<double>(normal(random), normal(random));
  return set;
}

/// Arguments: FRFs, lines. All orders to 60 with stabilisation data.
void BM_LscfOrder60(benchmark::State& state) {
  const signal::FrfSet set = noisy_frfs(state.range(0), state.range(1));
  for (auto _ : state) benchmark::DoNotOptimize(signal::lscf(set.frequency_hz, set.H, 1));
}
BENCHMARK(BM_LscfOrder60)->Args({20, 5600})->Args({222, 1601})->Unit(benchmark::kMillisecond);

/// Beside the time how many modes are found, how many without a warning (`sure`), and how many of
/// these hold the truth's frequency and damping in 95 % intervals.
void identify(benchmark::State& state, const signal::FrfSet& set,
              const Eigen::VectorXd& frequency_hz, const Eigen::VectorXd& damping_ratio) {
  signal::ModalResult result;
  for (auto _ : state) {
    result = signal::identify_modes(set);
    benchmark::DoNotOptimize(result.model.modes.data());
  }
  int sure = 0, f_held = 0, damping_held = 0;
  for (const signal::IdentifiedMode& mode : result.model.modes) {
    if (mode.doubtful) continue;
    ++sure;
    const auto &f = mode.frequency_hz, &damping = mode.damping_ratio;
    Eigen::Index nearest = 0;
    f_held += (frequency_hz.array() - f.value).abs().minCoeff(&nearest) < 1.96 * f.std;
    damping_held += std::abs(damping.value - damping_ratio[nearest]) < 1.96 * damping.std;
  }
  state.counters["modes"] = static_cast<double>(result.model.modes.size());
  state.counters["sure"] = sure;
  state.counters["f_held"] = f_held;
  state.counters["damping_held"] = damping_held;
}

void BM_IdentifyModes(benchmark::State& state) {
  const auto truth = testing::ten_mode_truth(state.range(0));
  identify(state, noisy_frfs(state.range(0), state.range(1)), truth.frequency_hz,
           truth.damping_ratio);
}
BENCHMARK(BM_IdentifyModes)->Args({222, 1601})->Unit(benchmark::kMillisecond);

/// Twelve modes of a bar under a roving hammer, 1601 lines to 420 Hz, damping 0.2 %. Arguments:
/// points, sensors, standard deviation of the poles between points in tenths of a half-power
/// bandwidth, noise in tenths of a per cent. The truth is the mean rig's.
void BM_IdentifyRovingHammer(benchmark::State& state) {
  testing::DefectiveFrfOptions options;
  options.frequency_hz.resize(12);
  for (int r = 0; r < 12; ++r) options.frequency_hz[r] = 41 + 30.7 * r + 0.3 * r * (r % 3);
  options.damping_ratio = 2e-3;
  options.low_hz = 20, options.high_hz = 420, options.spacing_hz = 0.25;
  options.points = state.range(0);
  options.fixed.clear();
  for (int e = 0; e < state.range(1); ++e) options.fixed.push_back(0.37 + 0.21 * e);
  options.scatter = 0.1 * static_cast<double>(state.range(2));
  options.noise = 1e-3 * static_cast<double>(state.range(3));
  identify(state, testing::defective_frfs(options), options.frequency_hz,
           Eigen::VectorXd::Constant(12, options.damping_ratio));
}
BENCHMARK(BM_IdentifyRovingHammer)
    ->ArgNames({"points", "sensors", "scatter", "noise"})
    ->Args({74, 3, 0, 2})
    ->Args({74, 3, 2, 2})
    ->Args({222, 1, 2, 20})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rigfit
