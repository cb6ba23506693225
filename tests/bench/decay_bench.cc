// Times of the free-decay estimator; accuracy of the same cases is in decay_truth.
#include <benchmark/benchmark.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "signal/damped_sinusoids.h"
#include "signal/decay.h"

namespace {

using Complex = std::complex<double>;

Eigen::VectorXd record(Eigen::Index n, double samples_a_cycle, double zeta, int modes) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal(0, 0.007);  // 40 dB
  Eigen::VectorXd y(n);
  for (double& v : y) v = normal(generator);
  for (int m = 0; m < modes; ++m) {
    const double w = 2 * std::numbers::pi / samples_a_cycle * (1 + 0.37 * m);
    const Complex p(-zeta * w, w * std::sqrt(1 - zeta * zeta));
    for (Eigen::Index j = 0; j < n; ++j) y(j) += std::exp(p * static_cast<double>(j)).real();
  }
  return y;
}

void decay(benchmark::State& state, Eigen::Index n, double samples_a_cycle, double zeta,
           int modes) {
  const auto y = record(n, samples_a_cycle, zeta, modes);
  for (auto _ : state) benchmark::DoNotOptimize(rigfit::signal::estimate_decay(y, 1000));
  state.SetItemsProcessed(state.iterations() * n);
}
BENCHMARK_CAPTURE(decay, axial_test_500_samples, 500, 10, 0.017, 1)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(decay, three_modes_4096_samples, 4096, 20, 0.005, 3)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(decay, million_samples, 1 << 20, 100, 1e-5, 1)->Unit(benchmark::kMillisecond);

void fit_only(benchmark::State& state) {
  const auto y = record(500, 10, 0.017, 1);
  const Complex start(-0.012, 0.6285);
  for (auto _ : state) {
    benchmark::DoNotOptimize(rigfit::signal::fit_damped_sinusoids(y, std::span(&start, 1)));
  }
}
BENCHMARK(fit_only)->Unit(benchmark::kMicrosecond);

}  // namespace
