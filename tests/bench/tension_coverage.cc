// Tension from frequencies: does the 95 % interval hold, how long does an estimate take? Cables of
// 0.5 to 1000 m and 1 N to 10 MN, any of the three kinds of ends, from taut to sagging, from
// flexible to stiff; three to eight modes, some missing, some false. The truth of a sagging cable
// is the segment model at the true parameters, 400 of them: none of the estimator's closed forms.
// Prints a table.
//   tension_coverage [SEEDS] [FIRST SEED] [PART OF A NAME]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "ident/tension/cable_model.h"
#include "ident/tension/cable_tension.h"
#include "model/linear/modal_analysis.h"

namespace {

using namespace rigfit;

struct Kind {
  const char* name;
  bool EI_known, sags, missing, false_mode, all_ends;
  bool EA_known = true;
  bool slight = false;  ///< Irvine's parameter from 0.5 to 5
};

struct Case {
  ident::CableDescription cable;
  double tension = 0;
  std::vector<ident::MeasuredMode> modes;
  bool drawn = false;
};

/// The first nine in-plane frequencies; fewer where the cable has no equilibrium.
std::vector<double> true_frequencies(const ident::CableDescription& cable, ident::CableEnds ends,
                                     const ident::CableState& truth, bool sags) {
  if (!sags) {
    const double all = std::numeric_limits<double>::infinity();
    return ident::CableModel(cable).frequencies(truth, 9, all).in_hz;
  }
  auto scene = ident::cable_scene(cable, ends, truth.tension_N, truth.EI_Nm2);
  if (ends == ident::CableEnds::springs) {
    for (auto& node : scene.nodes) node.support.rotational.setConstant(truth.spring_Nm_rad);
  }
  model::ModesOptions options;
  options.count = 9;
  options.plane = model::ModePlane::in;
  options.segments = 400;
  options.damped = options.shapes = options.error_estimate = false;
  options.torsion = false;
  std::vector<double> frequencies;
  for (const auto& mode : model::analyse_modes(scene, options).modes)
    frequencies.push_back(mode.frequency_hz);
  return frequencies;
}

Case draw(std::uint64_t seed, const Kind& kind) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  const auto decades = [&](double low, double high) {
    return low * std::pow(high / low, uniform(random));
  };
  Case one;
  auto& cable = one.cable;
  const double L = decades(0.5, 1000), T = decades(1, 1e7), x = decades(6, 300);
  double sag = kind.sags ? decades(2e-3, 0.05) : decades(1e-6, 1e-4);
  const double EI = T * L * L / (x * x), EA = T / decades(3e-4, 5e-3);
  if (kind.slight) sag = std::sqrt(decades(0.5, 5) * T / EA) / 8;
  const double m = 8 * sag * T / (model::kStandardGravity * L);
  one.tension = T;
  const double length_std = 5e-4, mass_std = 2e-3, EI_std = 0.05;
  const auto with_std = [&](double value, double relative) {
    return signal::Estimate{value * (1 + relative * normal(random)), relative * value};
  };
  cable.mass_reference = ident::MassReference::unstretched;
  cable.length_m = {L, 0};
  cable.mass_per_length = {m, 0};
  cable.EA_N = {EA, 0};
  cable.EI_Nm2 = {EI, 0};
  const auto ends =
      kind.all_ends ? static_cast<ident::CableEnds>(random() % 3) : ident::CableEnds::clamped;
  double spring = 0;
  if (ends == ident::CableEnds::clamped) spring = std::numeric_limits<double>::infinity();
  if (ends == ident::CableEnds::springs) spring = decades(0.05, 20) * EI * (x + 4) / L;
  const auto f = true_frequencies(cable, ends, {T, EI, spring}, kind.sags);
  if (f.size() < 9) return one;
  const double std = decades(1e-4, 3e-3);
  const auto count = 4 + random() % 5;
  const auto add = [&](double hz) {
    ident::MeasuredMode mode;
    mode.frequency_hz = {hz * (1 + std * normal(random)), std * hz};
    mode.damping_ratio = {std::nan(""), std::nan("")};
    mode.plane = model::ModePlane::in;
    one.modes.push_back(mode);
  };
  const auto missing = kind.missing ? random() % count : 99;
  for (std::size_t i = 0; i < count; ++i) {
    if (i != missing) add(f[i]);
  }
  if (kind.false_mode) add(f[0] * (0.6 + uniform(random) * static_cast<double>(count - 1)));
  cable.length_m = with_std(L, length_std);
  cable.mass_per_length = with_std(m, mass_std);
  if (kind.EA_known) {
    cable.EA_N = with_std(EA, 0.05);
  } else {
    cable.EA_N.reset();
  }
  if (kind.EI_known) {
    cable.EI_Nm2 = with_std(EI, EI_std);
  } else {
    cable.EI_Nm2.reset();
  }
  one.drawn = true;
  return one;
}

double seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 100;
  const auto first = static_cast<std::uint64_t>(argc > 2 ? std::atoi(argv[2]) : 1);
  const std::string only = argc > 3 ? argv[3] : "";
  const Kind kinds[] = {{"taut, clamped, EI known", true, false, false, false, false},
                        {"taut, clamped, EI free", false, false, false, false, false},
                        {"taut, any ends, EI known", true, false, false, false, true},
                        {"taut, any ends, EI free", false, false, false, false, true},
                        {"one mode missing", true, false, true, false, true},
                        {"one false mode", true, false, false, true, true},
                        {"missing and false", true, false, true, true, true},
                        {"sagging, EI known", true, true, false, false, true},
                        {"sagging, EI free", false, true, true, false, true},
                        {"slightly sagging, EI free", false, true, false, false, true, true, true},
                        {"sagging, EA unknown", true, true, false, false, true, false}};
  fmt::print("| {:<26} | {:>5} | {:>10} | {:>9} | {:>11} | {:>9} | {:>16} | {:>8} | {:>8} |\n",
             "cables", "cases", "undecided", "held, %", "med. std, %", "max err/s",
             "interval/1.96 std", "med., s", "max, s");
  fmt::print("|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& kind : kinds) {
    if (std::string(kind.name).find(only) == std::string::npos) continue;
    int cases = 0, undecided = 0, held = 0;
    std::vector<double> spread, time, shape;
    double worst = 0;
    for (int i = 0; i < seeds; ++i) {
      const auto one = draw(first + static_cast<std::uint64_t>(i), kind);
      if (!one.drawn) continue;
      ++cases;
      const double begin = seconds();
      const auto result = ident::identify_tension(one.cable, one.modes);
      time.push_back(seconds() - begin);
      if (!result.solved || !result.decided) {
        ++undecided;
        continue;
      }
      held += result.low <= one.tension && one.tension <= result.high;
      spread.push_back(100 * result.tension_N.std / result.tension_N.value);
      shape.push_back((result.high - result.low) / (2 * 1.96 * result.tension_N.std));
      worst =
          std::max(worst, std::abs(result.tension_N.value - one.tension) / result.tension_N.std);
    }
    std::sort(spread.begin(), spread.end());
    std::sort(time.begin(), time.end());
    std::sort(shape.begin(), shape.end());
    if (spread.empty()) continue;
    fmt::print(
        "| {:<26} | {:>5} | {:>10} | {:>9.1f} | {:>11.2g} | {:>9.2g} | {:>5.2f} .. {:>7.2f} | "
        "{:>8.2g} | {:>8.2g} |\n",
        kind.name, cases, undecided, 100.0 * held / (cases - undecided), spread[spread.size() / 2],
        worst, shape.front(), shape.back(), time[time.size() / 2], time.back());
    std::fflush(stdout);
  }
  return 0;
}
