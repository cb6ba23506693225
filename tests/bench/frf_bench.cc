// From a recorded impact test to FRFs: time, and beside it the error against the exact FRF of the
// system (largest over the responses of |H - exact| / |exact| in root mean squares below 1300 Hz).
#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <vector>

#include "signal/impact/impact_frfs.h"
#include "signal/spectra/fft.h"
#include "signal/spectra/frf.h"
#include "tests/reference/ten_mode_truth.h"

namespace {
using namespace rigfit;
using Eigen::Index;
constexpr Index kBlock = 32768;
constexpr double kWindowRate = 2;  // 1/s; the 25 Hz mode is then at 6e-7 by the end of a block

struct Prepared {
  testing::TenModeTruth truth;
  signal::Recording recording;
  std::vector<Index> responses;
  std::vector<std::string> names;
  signal::HitSearch search;
  std::vector<signal::FrfBlock> blocks;
  signal::FrfOptions options;
  double error = 0;

  Prepared(Index channels, double noise) : truth(testing::ten_mode_truth(channels)) {
    testing::ImpactRecordOptions record;
    record.noise = noise;
    record.block_samples = kBlock + 400;
    recording = testing::impact_recording(truth, record);
    for (Index c = 1; c <= channels; ++c) {
      responses.push_back(c);
      names.push_back("#" + std::to_string(c + 1));
    }
    signal::HitOptions hits;
    hits.block_s = kBlock / record.sample_rate_hz;
    search = signal::find_hits(std::span(&recording, 1), 0, responses, hits);
    for (const signal::Hit& hit : search.hits) {
      signal::FrfBlock block;
      const auto view = [&](Index c) {
        return std::span<const double>(
            recording.channels[static_cast<std::size_t>(c)].samples.data() + hit.block_first,
            static_cast<std::size_t>(kBlock));
      };
      block.force = view(0);
      block.force_offset = hit.offset;
      for (const Index c : responses) block.responses.push_back(view(c));
      blocks.push_back(block);
    }
    options.sample_rate_hz = record.sample_rate_hz;
    options.block_samples = kBlock;
    options.exponential_decay_rate_1_s = kWindowRate;
    const signal::FrfEstimate estimate = signal::average_frfs(blocks, options);
    const Index lines = (estimate.frequency_hz.array() < 1300).count();
    const Eigen::MatrixXcd exact =
        truth.accelerance(estimate.frequency_hz.head(lines), kWindowRate);
    for (Index c = 0; c < channels; ++c) {
      error = std::max(error,
                       (estimate.H.col(c).head(lines) - exact.col(c)).norm() / exact.col(c).norm());
    }
  }
};

void transform_32768(benchmark::State& state) {
  signal::RealFft fft(kBlock);
  fft.time().setRandom();
  for (auto _ : state) {
    fft.forward();
    benchmark::DoNotOptimize(fft.spectrum().data());
  }
}
BENCHMARK(transform_32768)->Unit(benchmark::kMicrosecond);

/// H1, coherence and error bars of five hits on so many channels.
void average_5_hits(benchmark::State& state) {
  const Prepared prepared(state.range(0), 0.005);
  const Prepared clean(state.range(0), 0);
  for (auto _ : state) {
    benchmark::DoNotOptimize(signal::average_frfs(prepared.blocks, prepared.options));
  }
  state.counters["hits"] = static_cast<double>(prepared.blocks.size());
  state.counters["error_noise_0.5%"] = prepared.error;
  state.counters["error_no_noise"] = clean.error;
}
BENCHMARK(average_5_hits)
    ->ArgName("channels")
    ->Arg(1)
    ->Arg(5)
    ->Arg(10)
    ->Arg(20)
    ->Arg(40)
    ->Unit(benchmark::kMillisecond);

/// The whole way: hits found and judged, outliers looked for, averaged.
void impact_test_20_channels(benchmark::State& state) {
  const Prepared prepared(20, 0.005);
  signal::ImpactTestOptions options;
  options.exponential_decay_rate_1_s = kWindowRate;
  options.threads = static_cast<int>(state.range(0));
  for (auto _ : state) {
    benchmark::DoNotOptimize(signal::analyse_impact_test(std::span(&prepared.recording, 1), "force",
                                                         prepared.names, options));
  }
}
BENCHMARK(impact_test_20_channels)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
