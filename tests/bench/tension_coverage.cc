// Tension from frequencies: does the 95 % interval hold, how long does an estimate take? Cables of
// 0.5 to 1000 m and 1 N to 10 MN, any of the three kinds of ends, from taut to sagging, from
// flexible to stiff; three to eight modes, some missing, some false. The truth is the closed form
// of a pinned or clamped beam, and for springs and sagging cables 400 segments (the fit has 30).
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "ident/tension/cable_tension.h"
#include "model/linear/modal_analysis.h"
#include "tests/bench/study.h"
#include "tests/reference/closed_forms.h"

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

/// The first nine in-plane frequencies; fewer where the cable has no equilibrium. Springs at the
/// ends, 0 for pinned ones.
std::vector<double> true_frequencies(const ident::CableDescription& cable, ident::CableEnds ends,
                                     double tension, double spring, bool sags) {
  const double EI = cable.EI_Nm2->value;
  const model::UniformBeam beam{cable.length_m.value, cable.mass_per_length.value, EI, tension};
  if (!sags && ends == ident::CableEnds::pinned) return model::pinned_beam_frequencies(beam, 9);
  if (!sags && ends == ident::CableEnds::clamped) return model::clamped_beam_frequencies(beam, 9);
  auto scene = ident::cable_scene(cable, ends, tension, EI);
  if (ends == ident::CableEnds::springs) {
    for (auto& node : scene.nodes) node.support.rotational.setConstant(spring);
  }
  model::ModesOptions options{.by_plane = {{9, 0}}, .segments = 400};
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
  if (ends == ident::CableEnds::springs) spring = decades(0.05, 20) * EI * (x + 4) / L;
  const auto f = true_frequencies(cable, ends, T, spring, kind.sags);
  if (f.size() < 9) return one;
  const double std = decades(1e-4, 3e-3);
  const auto count = 4 + random() % 5;
  const auto add = [&](double hz) {
    one.modes.push_back({.frequency_hz = {hz * (1 + std * normal(random)), std * hz},
                         .damping_ratio = {std::nan(""), std::nan("")},
                         .plane = model::ModePlane::in});
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

void estimate(const Kind& kind, std::uint64_t seed, study::Table& table) {
  const auto one = draw(seed, kind);
  if (!one.drawn) return;
  const auto [result, seconds] =
      study::timed([&] { return ident::identify_tension(one.cable, one.modes); });
  const bool decided = result.solved && result.decided;
  table.add("cases", 1);
  table.add("undecided", !decided);
  table.add("median, s", seconds);
  table.add("max, s", seconds);
  if (!decided) return;
  const auto& tension = result.tension_N;
  table.add("held, %", study::held(tension, one.tension));
  table.add("median std, %", 100 * tension.std / tension.value);
  table.add("largest error, std", std::abs(tension.value - one.tension) / tension.std);
}

}  // namespace

int main(int argc, char** argv) {
  using enum study::Of;
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
  study::run(study::arguments(argc, argv, 100),
             {"cables",
              {{"cases", sum},
               {"undecided", sum},
               {"held, %"},
               {"median std, %", median},
               {"largest error, std", largest},
               {"median, s", median},
               {"max, s", largest}}},
             kinds, estimate);
}
