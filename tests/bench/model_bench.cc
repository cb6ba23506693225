// Equilibrium and modes, from a parsed scene on, on one core.
#include <benchmark/benchmark.h>

#include "apps/bench/pole_line.h"
#include "model/modal_analysis.h"
#include "model/modes.h"
#include "tests/model/test_scenes.h"

namespace rigfit::model {
namespace {

void run(benchmark::State& state, const Scene& scene, int count) {
  ModesOptions options;
  options.count = count;
  int unknowns = 0;
  for (auto _ : state) {
    const ChainModes modes = find_modes(scene, options);
    if (!modes.complete()) state.SkipWithError("modes not counted");
    unknowns = 0;
    for (const auto& motion : modes.motions) unknowns += motion.assembly->size();
    benchmark::DoNotOptimize(modes.order.data());
  }
  state.counters["unknowns"] = unknowns;
}

void cable_first_6(benchmark::State& state) { run(state, testing::paper_cable(200, 0.5972), 6); }
void cable_past_crossover_first_6(benchmark::State& state) {
  run(state, testing::paper_cable(25, 0.2549), 6);
}
void rig_first_12(benchmark::State& state) { run(state, testing::cable_beam_rig(200, 0.5972), 12); }
void poles_first_50(benchmark::State& state) {
  run(state, apps::pole_line(static_cast<int>(state.range(0))), 50);
}
/// With damping, shapes and the error estimate.
void cable_whole_analysis(benchmark::State& state) {
  const Scene scene = testing::paper_cable(200, 0.5972);
  for (auto _ : state) benchmark::DoNotOptimize(analyse_modes(scene));
}

BENCHMARK(cable_first_6)->Unit(benchmark::kMicrosecond);
BENCHMARK(cable_past_crossover_first_6)->Unit(benchmark::kMicrosecond);
BENCHMARK(rig_first_12)->Unit(benchmark::kMicrosecond);
BENCHMARK(cable_whole_analysis)->Unit(benchmark::kMicrosecond);
BENCHMARK(poles_first_50)->Arg(12)->Arg(25)->Arg(50)->Arg(100)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rigfit::model
