// Damage of a wood pole's foot from the transverse frequencies of the line it stands in: 12 m above
// ground, two spans of 60 m with three ACSR conductors, the soil unknown. Measured are the modes of
// which the poles carry 2 % or more, below 8 Hz, to 0.1 %, with their shapes at two sensors on the
// pole. Is the damage inside its interval, how often is a sound pole called damaged, what is the
// smallest damage found, and how well is the bare pole's first mode known? Prints a table.
//   line_damage [SEEDS] [PART OF A NAME]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/campaign_file/new/utility_line.h"
#include "ident/predict/damage_estimate.h"
#include "ident/update/model_update.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/read_scene.h"

namespace {

using namespace rigfit;

constexpr double kStd = 1e-3, kTopHz = 8, kShare = 0.02, kSoilStd = 0.3;

struct Study {
  const char* name;
  double loss = 0;
  bool translation_free = false;  ///< the soil's translational spring, known to 30 % beforehand
  bool shaft_free = false;        ///< the pole's modulus
};

apps::UtilityLine line(double loss, int conductors) {
  apps::UtilityLine one;
  one.poles = 1;
  one.height_m = 12;
  one.ground_diameter_m = 0.32;
  one.conductors = conductors;
  one.damage_depth = loss;
  return one;
}

model::Scene scene_of(const apps::UtilityLine& one) {
  auto scene = model::parse_scene(apps::utility_line_scene(one), "line.toml");
  for (auto& sensor : scene.sensors) sensor.direction = {0, 0, 1};
  return scene;
}

model::ModesOptions transverse(int count) {
  model::ModesOptions options;
  options.count = count;
  options.plane = model::ModePlane::out;
  options.damped = options.error_estimate = false;
  return options;
}

std::vector<ident::MeasuredMode> measured(const model::Scene& scene, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<ident::MeasuredMode> modes;
  for (const auto& mode : model::analyse_modes(scene, transverse(25)).modes) {
    double poles = 0;
    for (std::size_t m = 0; m < scene.members.size(); ++m) {
      if (scene.members[m].name.starts_with("pole")) poles += mode.kinetic_energy[m];
    }
    if (poles < kShare || mode.frequency_hz > kTopHz) continue;
    ident::MeasuredMode one;
    one.frequency_hz = {mode.frequency_hz * (1 + kStd * normal(random)), kStd * mode.frequency_hz};
    one.damping_ratio = {std::nan(""), std::nan("")};
    one.plane = model::ModePlane::out;
    one.shape = mode.sensor_shape.cast<std::complex<double>>();
    modes.push_back(one);
  }
  return modes;
}

struct Row {
  int fits = 0, inside = 0, called = 0, held = 0, told = 0;
  double squares = 0;
  std::vector<double> std, bound;
};

void add(const Study& study, std::uint64_t seed, double bare_hz, Row& row) {
  ident::UpdateState state;
  state.name = "line";
  state.measured = measured(scene_of(line(study.loss, 3)), seed);
  auto start = line(0, 3), bare = line(0, 0);
  start.soil_rotational *= 1.5;  // nothing is known of it
  std::mt19937_64 random(seed + 1000000);
  std::normal_distribution<double> normal;
  if (study.translation_free) start.soil_translational *= std::exp(kSoilStd * normal(random));
  state.scene = scene_of(start);
  std::vector<std::string> names = {"pole1 base.EI", "ground1.rotational_x"};
  if (study.translation_free) names.emplace_back("ground1.translational_z");
  if (study.shaft_free) names.emplace_back("pole1 shaft.EI");
  std::vector<ident::FreeParameter> free(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) free[i].name = names[i];
  if (study.translation_free) {
    free[2].prior = {start.soil_translational, kSoilStd * start.soil_translational};
  }
  ident::UpdateOptions update;
  update.starts = 1;
  update.segment_uncertainty = false;  // the truth has the same segments
  const auto fit = ident::update_model({state}, free, update);
  if (fit.status != ident::UpdateStatus::converged) return;
  const auto fitted = ident::fitted_parameters(fit, free);
  const auto members = state.scene.members;
  const auto EI_of = [&](const std::string& name) {
    return std::find_if(members.begin(), members.end(),
                        [&](const auto& one) { return one.name == name; })
        ->EI[0];
  };
  ident::DamageQuestion question{"pole1 base.EI", "", {EI_of("pole1 base"), 0}, 1};
  if (study.shaft_free) {
    question.sound = "pole1 shaft.EI";
    question.sound_ratio = EI_of("pole1 base") / EI_of("pole1 shaft");
  }
  ident::DamageEstimate estimate;
  try {
    estimate = ident::damage_estimate(fitted, question);
  } catch (const std::invalid_argument&) {  // a parameter that the data do not tell
    return;
  }
  ident::PredictionOptions prediction;
  prediction.count = 1;
  const auto predicted = ident::predict_modes(scene_of(bare), fitted, prediction);
  if (predicted.modes.empty()) return;
  ++row.fits;
  row.inside += std::abs(estimate.damage.value - study.loss) <= 2 * estimate.damage.std;
  row.called += estimate.called;
  row.told += estimate.like.empty();
  row.std.push_back(estimate.damage.std);
  const double off = predicted.modes[0].frequency_hz.value / bare_hz - 1,
               bound = predicted.modes[0].frequency_hz.std / bare_hz;
  row.squares += off * off;
  row.bound.push_back(bound);
  row.held += std::abs(off) <= 1.96 * bound;
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 60;
  const std::string only = argc > 2 ? argv[2] : "";
  const auto first_hz = [](double loss, int conductors) {
    return model::analyse_modes(scene_of(line(loss, conductors)), transverse(1))
        .modes.front()
        .frequency_hz;
  };
  fmt::print(
      "{} modes; first mode {:.4f} Hz bare, {:.4f} Hz in the line; with 30 % lost {:+.2f} % "
      "and {:+.2f} %\n\n",
      measured(scene_of(line(0, 3)), 1).size(), first_hz(0, 0), first_hz(0, 3),
      100 * (first_hz(0.3, 0) / first_hz(0, 0) - 1), 100 * (first_hz(0.3, 3) / first_hz(0, 3) - 1));
  fmt::print(
      "| unknown beside the damage | lost | seeds | fits | damage in 2 std, % | called damaged, % "
      "| told apart, % | median std | smallest, 95 % | bare f1: rms error, % | bound: rms, % "
      "| median, % | in 1.96 bounds, % |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  const Study studies[] = {{"soil's rotation", 0.3},
                           {"soil's rotation", 0},
                           {"soil, shift known to 30 %", 0.3, true},
                           {"soil, shift known to 30 %", 0, true},
                           {"soil so, and modulus", 0.3, true, true},
                           {"soil so, and modulus", 0, true, true}};
  for (const auto& study : studies) {
    if (std::string(study.name).find(only) == std::string::npos) continue;
    Row row;
    const double bare_hz = first_hz(study.loss, 0);
    for (int seed = 1; seed <= seeds; ++seed) {
      add(study, static_cast<std::uint64_t>(seed), bare_hz, row);
    }
    if (row.fits == 0) {
      fmt::print("| {} | {:.0f} % | {} | 0 |\n", study.name, 100 * study.loss, seeds);
      continue;
    }
    double bound_squares = 0;  // the variance that the seeds state on average
    for (const double bound : row.bound) bound_squares += bound * bound;
    std::sort(row.std.begin(), row.std.end());
    std::sort(row.bound.begin(), row.bound.end());
    const auto middle = static_cast<std::size_t>(row.fits / 2);
    const double percent = 100.0 / row.fits;
    fmt::print(
        "| {} | {:.0f} % | {} | {} | {:.1f} | {:.1f} | {:.0f} | {:.3f} | {:.3f} | {:.3f} | "
        "{:.3f} | {:.3f} | {:.1f} |\n",
        study.name, 100 * study.loss, seeds, row.fits, row.inside * percent, row.called * percent,
        row.told * percent, row.std[middle], 2 * 1.644854 * row.std[middle],
        100 * std::sqrt(row.squares / row.fits), 100 * std::sqrt(bound_squares / row.fits),
        100 * row.bound[middle], row.held * percent);
    std::fflush(stdout);
  }
  return 0;
}
