// Equilibrium, modes and frequency response functions, from a parsed scene on, on one core; beside
// each time the relative error, and that of the reference it is taken against.
#include <benchmark/benchmark.h>

#include <cmath>

#include "model/frfs/frf_sensitivities.h"
#include "model/linear/modal_analysis.h"
#include "model/linear/modes.h"
#include "model/statics/equilibrium.h"
#include "tests/model/motion_scenes.h"
#include "tests/model/test_scenes.h"
#include "tests/reference/closed_forms.h"
#include "tests/reference/utility_line.h"

namespace rigfit::model {
namespace {

Scene refined(Scene scene, int times) {
  for (Member& member : scene.members) member.segments *= times;
  return scene;
}

double worst(const Eigen::VectorXd& found, const Eigen::VectorXd& truth) {
  if (found.size() != truth.size()) return 1;
  return (found.array() / truth.array() - 1).abs().maxCoeff();
}

/// A limp cable; its sag against the elastic catenary's.
void cable_at_rest(benchmark::State& state) {
  const auto tension = static_cast<double>(state.range(1));
  const Scene scene = testing::paper_cable(tension, 0, static_cast<int>(state.range(0)));
  double sag = 0;
  for (auto _ : state) {
    Chain chain = Chain::from_scene(scene);
    sag = describe(chain, find_equilibrium(chain, scene), scene).members[0].sag_m;
  }
  const Member& cable = scene.members[0];
  const CatenaryState truth =
      catenary_of_tension({2.4, 0, cable.mass_per_length * kStandardGravity, cable.EA}, tension);
  state.counters["relative_error"] = std::abs(sag / truth.sag_m - 1);
}
BENCHMARK(cable_at_rest)
    ->ArgNames({"segments", "tension_N"})
    ->ArgsProduct({{10, 30, 100, 1000, 10000}, {25, 200}})
    ->Unit(benchmark::kMicrosecond);

/// The frequencies' limit for vanishing segments from two finer chains, by second order; its own
/// error is what one step coarser would have given instead.
void run(benchmark::State& state, const Scene& scene, int count) {
  ModesOptions options;
  options.count = count;
  int unknowns = 0;
  const auto frequencies = [&](const Scene& of) {
    const ChainModes modes = find_modes(of, options);
    if (!modes.complete()) state.SkipWithError("modes not counted");
    Eigen::VectorXd hz(static_cast<Eigen::Index>(modes.order.size()));
    for (Eigen::Index i = 0; i < hz.size(); ++i) {
      hz[i] = modes.frequency_hz(static_cast<std::size_t>(i));
    }
    unknowns = 0;
    for (const auto& motion : modes.motions) unknowns += motion.assembly->size();
    return hz;
  };
  Eigen::VectorXd hz;
  for (auto _ : state) hz = frequencies(scene);
  state.counters["unknowns"] = unknowns;
  const Eigen::VectorXd fine = frequencies(refined(scene, 2)),
                        finer = frequencies(refined(scene, 4));
  if (hz.size() != fine.size() || fine.size() != finer.size()) return;
  const Eigen::VectorXd limit = (4 * finer - fine) / 3;
  state.counters["relative_error"] = worst(hz, limit);
  state.counters["reference_error"] = worst((4 * fine - hz) / 3, limit);
}

void cable_first_6(benchmark::State& state) {
  run(state, testing::paper_cable(200, 0.5972, static_cast<int>(state.range(0))), 6);
}
void cable_past_crossover_first_6(benchmark::State& state) {
  run(state, testing::paper_cable(25, 0.2549, static_cast<int>(state.range(0))), 6);
}
void rig_first_12(benchmark::State& state) {
  run(state, testing::cable_beam_rig(200, 0.5972, static_cast<int>(state.range(0))), 12);
}
void poles_first_50(benchmark::State& state) {
  run(state, apps::utility_line(static_cast<int>(state.range(0))), 50);
}
/// With damping, shapes and the error estimate, which stands beside the error itself.
void cable_whole_analysis(benchmark::State& state) {
  const Scene scene = testing::paper_cable(200, 0.5972, static_cast<int>(state.range(0)));
  ModalAnalysis analysis;
  for (auto _ : state) analysis = analyse_modes(scene);
  double error = 0;
  const ModalAnalysis fine = analyse_modes(refined(scene, 4));
  for (std::size_t i = 0; i < analysis.modes.size() && i < fine.modes.size(); ++i) {
    error = std::max(error,
                     std::abs(analysis.modes[i].frequency_hz / fine.modes[i].extrapolated_hz - 1));
  }
  state.counters["relative_error"] = error;
  state.counters["own_estimate"] = analysis.relative_error_estimate;
}
/// Rates of the first six frequencies with EI, EA and tension, the equilibrium's change included.
void cable_mode_sensitivities(benchmark::State& state) {
  const Scene scene = testing::paper_cable(200, 0.5972, static_cast<int>(state.range(0)));
  const std::vector<std::string> names{"cable.EI", "cable.EA", "cable.tension"};
  ModesOptions options;
  options.error_estimate = false;
  Eigen::MatrixXd rate;
  for (auto _ : state) rate = analyse_mode_sensitivities(scene, names, options).frequency;
  const Eigen::MatrixXd fine =
                            analyse_mode_sensitivities(refined(scene, 2), names, options).frequency,
                        finer =
                            analyse_mode_sensitivities(refined(scene, 4), names, options).frequency;
  const auto error_of = [&](const Eigen::MatrixXd& of) {
    return ((of - finer).colwise().norm().array() / finer.colwise().norm().array()).maxCoeff();
  };
  state.counters["relative_error"] = error_of(rate);
  state.counters["reference_error"] = error_of(fine) / 4;
}

BENCHMARK(cable_first_6)
    ->ArgName("segments")
    ->Arg(10)
    ->Arg(30)
    ->Arg(100)
    ->Arg(1000)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(cable_past_crossover_first_6)
    ->ArgName("segments")
    ->Arg(30)
    ->Arg(100)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(rig_first_12)
    ->ArgName("segments")
    ->Arg(10)
    ->Arg(30)
    ->Arg(100)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(cable_whole_analysis)
    ->ArgName("segments")
    ->Arg(30)
    ->Arg(100)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(cable_mode_sensitivities)
    ->ArgName("segments")
    ->Arg(30)
    ->Arg(100)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(poles_first_50)
    ->ArgName("poles")
    ->Arg(12)
    ->Arg(25)
    ->Arg(50)
    ->Arg(100)
    ->Unit(benchmark::kMillisecond);

/// The cable struck at its quarter span, displacement at its middle, 0.5 % damping.
Scene struck_cable(int segments) {
  Scene scene = testing::released_cable(segments);
  scene.loads[0].kind = Load::Kind::impact;
  scene.members[0].damping_ratio = 0.005;
  scene.sensors.pop_back();
  return scene;
}
/// Past the sixth frequency in the plane.
const Eigen::VectorXd& frf_lines() {
  static const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(200, 0.3, 60);
  return lines;
}
/// Root mean square over the lines, over the reference's.
double difference(const std::vector<Eigen::MatrixXcd>& found,
                  const std::vector<Eigen::MatrixXcd>& truth) {
  double error = 0, size = 0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    error += (found[k] - truth[k]).squaredNorm();
    size += truth[k].squaredNorm();
  }
  return std::sqrt(error / size);
}
constexpr int kFine = 480;

void frf_200_lines(benchmark::State& state) {
  const Scene scene = struck_cable(static_cast<int>(state.range(0)));
  SynthesizedFrfs found;
  for (auto _ : state) found = synthesize_frfs(scene, frf_lines());
  const auto fine = synthesize_frfs(struck_cable(kFine / 2), frf_lines()).H,
             finer = synthesize_frfs(struck_cable(kFine), frf_lines()).H;
  state.counters["relative_error"] = difference(found.H, finer);
  state.counters["reference_error"] = difference(fine, finer) / 4;  // second order
}
/// With the rates by EI, EA, tension and damping ratio; the error is the largest of the four.
void frf_200_lines_sensitivities(benchmark::State& state) {
  const std::vector<std::string> names{"cable.EI", "cable.EA", "cable.tension",
                                       "cable.damping_ratio"};
  const auto rates = [&](int segments) {
    return synthesize_frf_sensitivities(struck_cable(segments), frf_lines(), names).rate;
  };
  std::vector<std::vector<Eigen::MatrixXcd>> found;
  for (auto _ : state) found = rates(static_cast<int>(state.range(0)));
  const auto fine = rates(kFine / 2), finer = rates(kFine);
  double error = 0, reference = 0;
  for (std::size_t p = 0; p < names.size(); ++p) {
    error = std::max(error, difference(found[p], finer[p]));
    reference = std::max(reference, difference(fine[p], finer[p]) / 4);
  }
  state.counters["relative_error"] = error;
  state.counters["reference_error"] = reference;
}
BENCHMARK(frf_200_lines)
    ->ArgName("segments")
    ->Arg(15)
    ->Arg(30)
    ->Arg(60)
    ->Arg(120)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(frf_200_lines_sensitivities)
    ->ArgName("segments")
    ->Arg(15)
    ->Arg(30)
    ->Arg(60)
    ->Arg(120)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rigfit::model
