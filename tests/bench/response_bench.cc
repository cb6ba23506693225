// Responses of 10 s at 2 kHz, 30 segments, from a parsed scene to the samples, on one core. Beside
// the time the error of the displacement at mid-span, rms over rms, against the same segments with
// nothing left out: the linear answer with all modes at four times the rate (which says what its
// recurrence loses), motions at a twelfth of the natural step.
#include <benchmark/benchmark.h>

#include "model/response/response.h"
#include "tests/model/motion_scenes.h"

namespace rigfit::model {
namespace {

/// What is compared with, at the rate asked for.
Eigen::VectorXd reference(const Scene& scene, ResponseOptions options, ResponseSolver solver,
                          double natural_step_s, int parts) {
  options.sampling.energy_samples = 0;
  options.solver = solver;
  options.axial = true;
  int stride = 1;
  if (solver == ResponseSolver::modal) {
    options.sampling.rate_hz *= stride = parts;
    options.modes = 1000;
  } else {
    options.step_s = natural_step_s / parts;
  }
  const Eigen::VectorXd all = simulate_response(scene, options).samples.col(0);
  return all(Eigen::seq(0, all.size() - 1, stride));
}

void run(benchmark::State& state, const Scene& scene, std::optional<bool> axial, int energy) {
  ResponseOptions options;
  options.sampling = {.duration_s = 10, .rate_hz = 2000, .energy_samples = energy};
  options.axial = axial;
  ResponseResult result;
  for (auto _ : state) result = simulate_response(scene, options);
  if (!result.completed) return state.SkipWithError("not completed");
  state.counters["steps"] = static_cast<double>(result.steps);
  state.counters["drift"] = result.energy_drift;
  const bool linear = result.solver == ResponseSolver::modal;
  ResponseOptions natural = options;
  natural.sampling.duration_s = 0.01;
  natural.solver = result.solver;
  natural.axial = true;
  const double step_s = simulate_response(scene, natural).step_s;
  const Eigen::VectorXd coarser = reference(scene, options, result.solver, step_s, linear ? 2 : 6);
  const Eigen::VectorXd finest = reference(scene, options, result.solver, step_s, linear ? 4 : 12);
  const double motion = (finest.array() - finest.mean()).matrix().norm();
  state.counters["relative_error"] = (result.samples.col(0) - finest).norm() / motion;
  // Dampers are split off with second order.
  state.counters["reference_error"] = (coarser - finest).norm() / motion / (linear ? 1 : 3);
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
BENCHMARK(linear_release)->Unit(benchmark::kMicrosecond);
BENCHMARK(linear_hit)->Unit(benchmark::kMicrosecond);
BENCHMARK(linear_hit_with_energy)->Unit(benchmark::kMicrosecond);
BENCHMARK(release)->Unit(benchmark::kMillisecond);
BENCHMARK(release_damped)->Unit(benchmark::kMillisecond);
BENCHMARK(release_by_need)->Unit(benchmark::kMillisecond);
BENCHMARK(release_damped_by_need)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rigfit::model
