// FRFs with the defects of measured ones (tests/reference/defective_frfs.h) over seeds: modes lost,
// modes that are none, and how often 95 % intervals of the mean rig's frequency and damping hold
// it, doubtful modes apart. Prints a Markdown table.
//
//   modal_defects [--seeds N] [--first SEED] [--case NAME]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "signal/modal/modal_identification.h"
#include "tests/reference/defective_frfs.h"

namespace rigfit {
namespace {

struct Case {
  std::string name;
  testing::DefectiveFrfOptions options;
};

/// A beam's accelerances from records of 8 s that end with `left` of its first mode's amplitude.
void beam(testing::DefectiveFrfOptions& options, double left, double before) {
  options.frequency_hz.resize(4);
  options.frequency_hz << 2.0924, 13.11, 36.71, 47.3;
  options.record_s = 8;
  options.before_hit_s = before * options.record_s;
  options.spacing_hz = 1 / options.record_s;
  options.low_hz = options.spacing_hz, options.high_hz = 60;
  options.damping_ratio = -std::log(left) / (2 * std::numbers::pi * 2.0924 * options.record_s);
  options.points = 3, options.points_are_inputs = false;
  options.noise = 1e-3;
}

std::vector<Case> cases() {
  const testing::DefectiveFrfOptions bar;
  std::vector<Case> list{{"noise only", bar}};
  const auto add = [&](const std::string& name, auto change) {
    Case one{name, bar};
    change(one.options);
    list.push_back(one);
  };
  for (const double d : {0.2, 1.0, 5.0, 20.0}) {
    add(fmt::format("drift over {} bandwidths", d), [&](auto& o) { o.drift = d; });
  }
  for (const double d : {0.2, 1.0, 5.0}) {
    add(fmt::format("scatter of {} bandwidths", d), [&](auto& o) { o.scatter = d; });
  }
  const auto plate = [](auto& o) {  // damped, coarse lines, one hit
    o.damping_ratio = 0.005;
    o.spacing_hz = 0.5;
    o.low_hz = 20;
    o.high_hz = 400;
    o.noise = 0.02;
  };
  add("one hit, 8 points", plate);
  add("one hit, 1 FRF", [&](auto& o) { plate(o), o.points = 1; });
  add("one hit, 8 sensors, force noise 2 %",
      [&](auto& o) { plate(o), o.points_are_inputs = false, o.common = 0.02, o.noise = 0.002; });
  add("1 FRF, force noise 2 %",
      [&](auto& o) { plate(o), o.points = 1, o.common = 0.02, o.noise = 0.002; });
  add("cubic spring, 0.3 bandwidths",
      [&](auto& o) { plate(o), o.noise = 0.002, o.softening = 0.3; });
  add("cubic spring, 1 bandwidth", [&](auto& o) { plate(o), o.noise = 0.002, o.softening = 1; });
  add("cubic spring, 0.3 bandwidths, hits' sizes not known",
      [&](auto& o) { plate(o), o.noise = 0.002, o.softening = 0.3, o.hit_sizes = false; });
  add("leakage, 0.05 %, 1 s records", [&](auto& o) {
    plate(o), o.damping_ratio = 5e-4, o.spacing_hz = 1, o.record_s = 1, o.noise = 0.005;
  });
  for (const double left : {0.02, 0.1, 0.3, 0.53}) {
    for (const double before : {0.0, 0.01, 0.05}) {
      add(fmt::format("{} % left at the end, {} % before the hit", 100 * left, 100 * before),
          [&](auto& o) { beam(o, left, before); });
    }
  }
  add("30 % left at the end under an exponential window, 1 % before the hit", [&](auto& o) {
    beam(o, 0.6, 0.01);
    o.window_decay_1_s = std::log(2.0) / o.record_s;
  });
  return list;
}

struct Tally {
  int sets = 0, modes = 0, lost = 0, doubtful = 0, sure = 0, f_covered = 0, z_covered = 0;
  int false_sure = 0, false_doubtful = 0, sets_with_false = 0, local = 0;
  double seconds = 0;
};

void one_set(const testing::DefectiveFrfOptions& options, Tally& tally) {
  const signal::FrfSet set = testing::defective_frfs(options);
  const auto begin = std::chrono::steady_clock::now();
  const signal::ModalResult found = identify_modes(set);
  tally.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  ++tally.sets;
  std::vector<bool> taken(found.model.modes.size(), false);
  for (const double f : options.frequency_hz) {
    ++tally.modes;
    const double reach = 2 * options.damping_ratio * f *
                             (0.5 + 0.5 * options.drift + 2 * options.scatter + options.softening) +
                         2 * options.spacing_hz;
    std::size_t best = taken.size();
    for (std::size_t r = 0; r < taken.size(); ++r) {
      const double away = std::abs(found.model.modes[r].frequency_hz.value - f);
      if (taken[r] || away > reach) continue;
      if (best == taken.size() || away < std::abs(found.model.modes[best].frequency_hz.value - f)) {
        best = r;
      }
    }
    if (best == taken.size()) {
      ++tally.lost;
      continue;
    }
    taken[best] = true;
    const signal::IdentifiedMode& mode = found.model.modes[best];
    tally.local += mode.refinement != "global";
    if (mode.doubtful) {
      ++tally.doubtful;
      continue;
    }
    ++tally.sure;
    tally.f_covered += std::abs(mode.frequency_hz.value - f) < 1.96 * mode.frequency_hz.std;
    tally.z_covered +=
        std::abs(mode.damping_ratio.value - options.damping_ratio) < 1.96 * mode.damping_ratio.std;
  }
  bool any = false;
  for (std::size_t r = 0; r < taken.size(); ++r) {
    if (taken[r]) continue;
    ++(found.model.modes[r].doubtful ? tally.false_doubtful : tally.false_sure);
    any = any || !found.model.modes[r].doubtful;
  }
  tally.sets_with_false += any;
}

int run(int argc, char** argv) {
  int seeds = 20, first = 1;
  std::string only;
  CLI::App app{"Modes from FRFs with the defects of measured ones: coverage and false modes"};
  app.add_option("--seeds", seeds)->check(CLI::Range(1, 100000))->capture_default_str();
  app.add_option("--first", first)->capture_default_str();
  app.add_option("--case", only, "Only cases whose name holds this");
  CLI11_PARSE(app, argc, argv);
  fmt::print(
      "| case | f in 95 % | damping in 95 % | of sure modes | doubtful | lost | sets with sure "
      "false "
      "modes | false but doubtful | local | s a set "
      "|\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Case& one : cases()) {
    if (one.name.find(only) == std::string::npos) continue;
    Tally t;
    for (int seed = 0; seed < seeds; ++seed) {
      testing::DefectiveFrfOptions options = one.options;
      options.seed = static_cast<std::uint64_t>(first + seed);
      one_set(options, t);
    }
    const double sure = std::max(1, t.sure);
    fmt::print("| {} | {:.1f} % | {:.1f} % | {} | {} | {} of {} | {} of {} | {} | {} | {:.2f} |\n",
               one.name, 100 * t.f_covered / sure, 100 * t.z_covered / sure, t.sure, t.doubtful,
               t.lost, t.modes, t.sets_with_false, t.sets, t.false_doubtful, t.local,
               t.seconds / t.sets);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace rigfit

int main(int argc, char** argv) { return rigfit::run(argc, argv); }
