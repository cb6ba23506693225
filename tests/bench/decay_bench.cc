// Times of the free-decay estimator, and beside them how far the worst of its modes is from the
// truth in this one record and what it says itself (both relative); decay_truth has many records.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "signal/decay/decay.h"
#include "signal/sinusoids/damped_sinusoids.h"

namespace {

using Complex = std::complex<double>;

constexpr double kRate = 1000;

double angular(double samples_a_cycle, int mode) {  // rad a sample, undamped
  return 2 * std::numbers::pi / samples_a_cycle * (1 + 0.37 * mode);
}

Eigen::VectorXd record(Eigen::Index n, double samples_a_cycle, double zeta, int modes) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal(0, 0.007);  // 40 dB
  Eigen::VectorXd y(n);
  for (double& v : y) v = normal(generator);
  for (int m = 0; m < modes; ++m) {
    const double w = angular(samples_a_cycle, m);
    const Complex p(-zeta * w, w * std::sqrt(1 - zeta * zeta));
    for (Eigen::Index j = 0; j < n; ++j) y(j) += std::exp(p * static_cast<double>(j)).real();
  }
  return y;
}

void decay(benchmark::State& state, Eigen::Index n, double samples_a_cycle, double zeta,
           int modes) {
  const auto y = record(n, samples_a_cycle, zeta, modes);
  rigfit::signal::DecayResult found;
  for (auto _ : state) found = rigfit::signal::estimate_decay(y, kRate);
  state.SetItemsProcessed(state.iterations() * n);
  if (found.modes.size() != static_cast<std::size_t>(modes)) {
    return state.SkipWithError("another number of modes");
  }
  double frequency = 0, damping = 0, damping_std = 0, frequency_over_std = 0, damping_over_std = 0;
  for (int m = 0; m < modes; ++m) {
    const double hz = angular(samples_a_cycle, m) * kRate / (2 * std::numbers::pi);
    const auto& mode = *std::min_element(
        found.modes.begin(), found.modes.end(), [hz](const auto& a, const auto& b) {
          return std::abs(a.frequency_hz.value - hz) < std::abs(b.frequency_hz.value - hz);
        });
    frequency = std::max(frequency, std::abs(mode.frequency_hz.value / hz - 1));
    damping = std::max(damping, std::abs(mode.damping_ratio.value / zeta - 1));
    damping_std = std::max(damping_std, mode.damping_ratio.std / zeta);
    frequency_over_std = std::max(frequency_over_std,
                                  std::abs(mode.frequency_hz.value - hz) / mode.frequency_hz.std);
    damping_over_std = std::max(damping_over_std,
                                std::abs(mode.damping_ratio.value - zeta) / mode.damping_ratio.std);
  }
  state.counters["frequency_error"] = frequency;
  state.counters["damping_error"] = damping;
  state.counters["damping_std"] = damping_std;
  state.counters["frequency_error_over_std"] = frequency_over_std;
  state.counters["damping_error_over_std"] = damping_over_std;
}
BENCHMARK_CAPTURE(decay, axial_test_500_samples, 500, 10, 0.017, 1)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(decay, three_modes_4096_samples, 4096, 20, 0.005, 3)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(decay, million_samples, 1 << 20, 100, 1e-5, 1)->Unit(benchmark::kMillisecond);

/// The amplitude falls by e^-6 over the record.
void long_decay(benchmark::State& state) {
  const auto n = static_cast<Eigen::Index>(state.range(0));
  decay(state, n, 20, 6 / static_cast<double>(n) / angular(20, 0), 1);
}
BENCHMARK(long_decay)
    ->Arg(10'000'000)
    ->Arg(100'000'000)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

void fit_only(benchmark::State& state) {
  const auto y = record(500, 10, 0.017, 1);
  const Complex start(-0.012, 0.6285);
  rigfit::signal::DampedSinusoidsFit found;
  for (auto _ : state) found = rigfit::signal::fit_damped_sinusoids(y, std::span(&start, 1));
  const Complex p = found.poles[0];
  state.counters["frequency_error"] = std::abs(std::abs(p) / angular(10, 0) - 1);
  state.counters["damping_error"] = std::abs(-p.real() / std::abs(p) / 0.017 - 1);
}
BENCHMARK(fit_only)->Unit(benchmark::kMicrosecond);

}  // namespace
