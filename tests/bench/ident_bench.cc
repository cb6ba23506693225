// What is identified: time, and beside it the relative error against the truth that the data were
// computed from. Exact data show what the method loses, records with noise what it says of itself
// (`std`, relative, of the same value).
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <numbers>
#include <vector>

#include "ident/axial/axial_identification.h"
#include "ident/bending/bending_analysis.h"
#include "ident/campaign/modal/mode_lines.h"
#include "ident/predict/scene_prediction.h"
#include "ident/virtual_rig/virtual_axial.h"
#include "ident/virtual_rig/virtual_bending.h"
#include "signal/decay/decay.h"
#include "tests/bench/cable_update.h"
#include "tests/model/test_scenes.h"
#include "tests/reference/exact_bending_ratio.h"

namespace rigfit::ident {
namespace {

void count(benchmark::State& state, const signal::Estimate& found, double truth) {
  state.counters["relative_error"] = std::abs(found.value / truth - 1);
  state.counters["std"] = found.std / truth;
}

/// lambda from the bending equation's ratio, in EI: twice its error. The ratio as a double is off
/// by half a unit in its last place, which is the reference's own error.
void bending_equation(benchmark::State& state) {
  const double lambda = 0.1 * static_cast<double>(state.range(0));
  const auto ratio = static_cast<double>(apps::exact_bending_ratio(lambda));
  double found = 0;
  for (auto _ : state) benchmark::DoNotOptimize(found = lambda_from_bending_ratio(ratio));
  state.counters["relative_error"] = std::abs(std::pow(lambda / found, 2) - 1);
  state.counters["reference_error"] =
      std::numeric_limits<double>::epsilon() * ratio / bending_ratio_log_derivative(lambda);
}
BENCHMARK(bending_equation)->ArgName("tenths_of_lambda")->Arg(3)->Arg(20)->Arg(80)->Arg(250);

/// The same with the interval, slope, tension and span known to 0.1 %.
void bending_stiffness(benchmark::State& state) {
  const double lambda = 0.1 * static_cast<double>(state.range(0)), tension = 100, span = 0.5;
  const double EI = tension * span * span / (4 * lambda * lambda);
  const auto slope = static_cast<double>(apps::exact_bending_ratio(lambda) * span / (4 * tension));
  StiffnessFromBending found;
  for (auto _ : state) {
    found = stiffness_from_compliance(
        {{slope, 1e-3 * slope}, {tension, 1e-3 * tension}, {span, 1e-3 * span}, 20});
  }
  count(state, found.EI_Nm2, EI);
}
BENCHMARK(bending_stiffness)
    ->ArgName("tenths_of_lambda")
    ->Arg(3)
    ->Arg(20)
    ->Arg(80)
    ->Arg(250)
    ->Unit(benchmark::kMicrosecond);

/// A record with wire friction and noise: 2400 samples, two loadings and unloadings at 200 N.
void bending_record(benchmark::State& state) {
  VirtualBendingTest test;
  test.EI_Nm2 = 0.5, test.tension_N = 200, test.span_m = 0.5;
  test.friction_load_N = 0.1, test.friction_travel_m = 2e-4;
  test.load_cell.noise_std = 0.01, test.lvdt.noise_std = 1e-6, test.tension_cell.noise_std = 0.1;
  Random random = random_stream(1, 1);
  const auto recording = virtual_bending_record(test, random);
  const BendingRecord record{recording.channel("tension").samples,
                             recording.channel("load").samples,
                             recording.channel("deflection").samples};
  BendingTestOptions options;
  options.span_m = {0.5, 0};
  BendingTestResult found;
  for (auto _ : state) found = analyse_bending_test(record, options);
  if (found.refused) return state.SkipWithError("refused");
  count(state, found.stiffness.EI_Nm2, test.EI_Nm2);
  state.counters["samples"] = static_cast<double>(record.load_N.size());
}
BENCHMARK(bending_record)->Unit(benchmark::kMillisecond);

constexpr double kEA = 221780, kMassPerLength = 0.16667, kDamping = 0.017;

AxialSetup axial_setup() {
  AxialSetup setup;
  setup.mass_kg = {2.2, 0.005};
  setup.mass_per_length_kg_m = {kMassPerLength, 0.001};
  setup.length_std_m = 0.002;
  return setup;
}

VirtualAxialTest axial_tap(double length_m) {
  VirtualAxialTest test;
  test.EA_N = kEA, test.damping_ratio = kDamping;
  test.hung_mass_kg = 2.2, test.mass_per_length_kg_m = kMassPerLength, test.length_m = length_m;
  test.after_s = 1, test.before_s = 0.2;
  test.load_cell.noise_std = 1, test.load_cell.offset_std = 1;
  return test;
}

/// EA of fifteen decays at three lengths, the frequencies those of the continuous rod.
void axial_EA(benchmark::State& state) {
  std::vector<AxialDecay> decays;
  for (const double length : {0.7, 1.0, 1.3}) {
    const double hz = axial_truth(axial_tap(length)).frequency_hz;
    for (int tap = 0; tap < 5; ++tap) {
      decays.push_back({"tap", length, {hz, 1e-4 * hz}, {kDamping, 1e-3 * kDamping}});
    }
  }
  AxialTestResult found;
  for (auto _ : state) found = identify_axial(decays, axial_setup());
  count(state, found.EA_N, kEA);
}
BENCHMARK(axial_EA)->Unit(benchmark::kMicrosecond);

/// From fifteen records of the load cell on.
void axial_records(benchmark::State& state) {
  Random random = random_stream(1, 2);
  std::vector<std::pair<double, signal::Recording>> records;
  for (const double length : {0.7, 1.0, 1.3}) {
    for (int tap = 0; tap < 5; ++tap) {
      records.emplace_back(length, virtual_axial_record(axial_tap(length), random));
    }
  }
  AxialTestResult found;
  for (auto _ : state) {
    std::vector<AxialDecay> decays;
    for (const auto& [length, record] : records) {
      const auto decay = signal::estimate_decay(record.channels[0].samples, record.sample_rate_hz);
      if (!decay.refusal.empty()) return state.SkipWithError("a decay was refused");
      decays.push_back(
          {"tap", length, decay.modes[0].damped_frequency_hz, decay.modes[0].damping_ratio});
    }
    found = identify_axial(decays, axial_setup());
  }
  count(state, found.EA_N, kEA);
  state.counters["damping_error"] = std::abs(found.damping_ratio.value / kDamping - 1);
}
BENCHMARK(axial_records)->Unit(benchmark::kMillisecond);

/// EI and two tensions from six frequencies at each; 0 segments: "auto".
void update_EI_and_tensions(benchmark::State& state) {
  static const apps::CableUpdate problem(240);
  UpdateOptions options;
  options.starts = static_cast<int>(state.range(1));
  UpdateResult found;
  for (auto _ : state) found = problem.fit(static_cast<int>(state.range(0)), options);
  state.counters["relative_error"] = problem.error_of(found);
  state.counters["reference_error"] = problem.reference_error();
  state.counters["models"] = found.model_evaluations;
}
BENCHMARK(update_EI_and_tensions)
    ->ArgNames({"segments", "starts"})
    ->Args({10, 1})
    ->Args({30, 1})
    ->Args({90, 1})
    ->Args({30, 4})
    ->Args({0, 1})
    ->Args({0, 4})
    ->Unit(benchmark::kMillisecond);

/// The report's figure: modes to 55 Hz along 49 tensions from 25 to 300 N, "auto" to 1e-4. The
/// error is against "auto" to 1e-7; `pieces` are as many as lines where none breaks.
void lines_along_tensions(benchmark::State& state) {
  double accuracy = 1e-4;
  const auto scene_at = [&](double tension_N) {
    model::Scene scene = state.range(0) != 0 ? model::testing::cable_beam_rig(tension_N, 0.5972, 0)
                                             : model::testing::paper_cable(tension_N, 0.5972, 0);
    scene.accuracy = accuracy;
    return scene;
  };
  const auto follow = [&] { return follow_modes(scene_at, 25, 300, 48, 55); };
  ModeLines found;
  for (auto _ : state) found = follow();
  accuracy = 1e-7;
  const ModeLines truth = follow();
  state.counters["pieces"] = static_cast<double>(found.lines.size());
  if (truth.lines.size() != found.lines.size()) return state.SkipWithError("other lines to 1e-7");
  double worst = 0;
  for (std::size_t l = 0; l < found.lines.size(); ++l) {
    const auto &one = found.lines[l].frequency_hz, &exact = truth.lines[l].frequency_hz;
    for (std::size_t i = 0; i < std::min(one.size(), exact.size()); ++i) {
      worst = std::max(worst, std::abs(one[i] / exact[i] - 1));
    }
  }
  state.counters["relative_error"] = worst;
}
BENCHMARK(lines_along_tensions)->ArgName("rig")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

/// `predict` with 200 samples, tension known to 3 %, EI to 10 %, to 10^-`accuracy`.
/// `one_by_one_ms`: the same scenes (209 with the check of linearity) by `analyse_modes`.
void sampled_prediction(benchmark::State& state) {
  const bool rig = state.range(0) != 0;
  model::Scene scene = rig ? model::testing::cable_beam_rig(200, 0.5972, 0)
                           : model::testing::paper_cable(200, 0.5972, 0);
  scene.accuracy = std::pow(10.0, -static_cast<double>(state.range(1)));
  FittedParameters fitted;
  fitted.parameters = {{"tension", 200}, {"EI", 0.5972}};
  for (auto& parameter : fitted.parameters) {
    for (const char* member : {"cable", "left cable", "right cable"}) {
      if (rig != (member == std::string("cable"))) {
        parameter.targets.push_back(std::string(member) + "." + parameter.name);
      }
    }
  }
  fitted.covariance =
      Eigen::Vector2d(std::pow(0.03 * 200, 2), std::pow(0.1 * 0.5972, 2)).asDiagonal();
  PredictionOptions options;
  options.count = rig ? 12 : 6;
  options.always_sample = true;
  ModePrediction found;
  for (auto _ : state) found = predict_modes(scene, fitted, options);
  model::ModesOptions alone;
  alone.count = options.count;
  alone.shapes = alone.damped = alone.error_estimate = false;
  const std::clock_t begin = std::clock();
  for (int i = 0; i < options.samples + 9; ++i) {
    benchmark::DoNotOptimize(model::analyse_modes(scene, alone));
  }
  state.counters["one_by_one_ms"] =
      1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  state.counters["first_std_hz"] = found.modes[0].frequency_hz.std;
  state.counters["first_low_hz"] = found.modes[0].low_hz;
  state.counters["first_high_hz"] = found.modes[0].high_hz;
}
BENCHMARK(sampled_prediction)
    ->ArgNames({"rig", "accuracy"})
    ->Args({0, 4})
    ->Args({0, 6})
    ->Args({1, 4})
    ->Args({1, 6})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rigfit::ident
