// Responses of 10 s at 2 kHz, 30 segments, from a parsed scene to the samples, on one core.
#include <benchmark/benchmark.h>

#include "model/response.h"
#include "tests/model/motion_scenes.h"

namespace rigfit::model {
namespace {

void run(benchmark::State& state, const Scene& scene, std::optional<bool> axial, int energy) {
  ResponseOptions options;
  options.sampling = {.duration_s = 10, .rate_hz = 2000, .energy_samples = energy};
  options.axial = axial;
  double drift = 0;
  long steps = 0;
  for (auto _ : state) {
    const ResponseResult result = simulate_response(scene, options);
    if (!result.completed) state.SkipWithError("not completed");
    drift = result.energy_drift;
    steps = result.steps;
    benchmark::DoNotOptimize(result.samples.data());
  }
  state.counters["steps"] = static_cast<double>(steps);
  state.counters["drift"] = drift;
}

Scene released(double mass, double damping_ratio, bool displacement_only) {
  Scene scene = testing::released_cable(30, mass);
  if (damping_ratio > 0) scene.members[0].damping_ratio = damping_ratio;
  if (displacement_only) scene.sensors.pop_back();
  return scene;
}

/// Linear by its size: 2 g; with all modes.
void linear_release(benchmark::State& state) { run(state, released(0.002, 0.005, false), {}, 0); }
void linear_hit(benchmark::State& state) {
  Scene scene = released(0.002, 0.005, false);
  scene.loads[0].kind = Load::Kind::impact;
  scene.loads[0].peak = 0.5;
  scene.loads[0].duration = 0.002;
  run(state, scene, {}, 0);
}
void linear_hit_with_energy(benchmark::State& state) {
  Scene scene = released(0.002, 0.005, false);
  scene.loads[0].kind = Load::Kind::impact;
  scene.loads[0].peak = 0.5;
  scene.loads[0].duration = 0.002;
  run(state, scene, {}, 20);
}
/// The 1 kg release, axial waves at their own speed, or as displacements need them.
void release(benchmark::State& state) { run(state, released(1, 0, false), true, 200); }
void release_damped(benchmark::State& state) { run(state, released(1, 0.005, false), true, 200); }
void release_by_need(benchmark::State& state) { run(state, released(1, 0, true), {}, 200); }
void release_damped_by_need(benchmark::State& state) {
  run(state, released(1, 0.005, true), {}, 200);
}
void release_joint_dampers(benchmark::State& state) {
  Scene scene = released(1, 0, true);
  scene.members[0].damping = {.axial = 30, .bending = 0.05, .torsion = 0};
  run(state, scene, {}, 200);
}

BENCHMARK(linear_release)->Unit(benchmark::kMicrosecond);
BENCHMARK(linear_hit)->Unit(benchmark::kMicrosecond);
BENCHMARK(linear_hit_with_energy)->Unit(benchmark::kMicrosecond);
BENCHMARK(release)->Unit(benchmark::kMillisecond);
BENCHMARK(release_damped)->Unit(benchmark::kMillisecond);
BENCHMARK(release_by_need)->Unit(benchmark::kMillisecond);
BENCHMARK(release_damped_by_need)->Unit(benchmark::kMillisecond);
BENCHMARK(release_joint_dampers)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rigfit::model
