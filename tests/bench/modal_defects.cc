// FRFs with the defects of measured ones (tests/reference/defective_frfs.h) over seeds: modes lost,
// modes that are none, and how often 95 % intervals of the mean rig's frequency and damping hold
// it, doubtful modes apart.
#include "signal/modal/modal_identification.h"
#include "tests/bench/study.h"
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
  const auto plate = [](auto& o) {  // damped, coarse lines, one hit
    o.damping_ratio = 0.005;
    o.spacing_hz = 0.5;
    o.low_hz = 20;
    o.high_hz = 400;
    o.noise = 0.02;
  };
  add("one hit, 8 sensors, force noise 2 %",
      [&](auto& o) { plate(o), o.points_are_inputs = false, o.common = 0.02, o.noise = 0.002; });
  add("1 FRF, force noise 2 %",
      [&](auto& o) { plate(o), o.points = 1, o.common = 0.02, o.noise = 0.002; });
  add("leakage, 0.05 %, 1 s records", [&](auto& o) {
    plate(o), o.damping_ratio = 5e-4, o.spacing_hz = 1, o.record_s = 1, o.noise = 0.005;
  });
  for (const double left : {0.02, 0.3}) {
    for (const double before : {0.0, 0.01, 0.05}) {
      add(fmt::format("{} % left at the end, {} % before the hit", 100 * left, 100 * before),
          [&](auto& o) { beam(o, left, before); });
    }
  }
  return list;
}

void identify(const Case& one, std::uint64_t seed, study::Table& table) {
  testing::DefectiveFrfOptions options = one.options;
  options.seed = seed;
  const signal::FrfSet set = testing::defective_frfs(options);
  const auto [found, seconds] = study::timed([&] { return identify_modes(set); });
  table.add("s a set", seconds);
  const auto& modes = found.model.modes;
  std::vector<bool> taken(modes.size(), false);
  for (const double f : options.frequency_hz) {
    const double reach = options.damping_ratio * f + 2 * options.spacing_hz;
    const int best = study::take_nearest(
        taken, reach, [&](std::size_t r) { return std::abs(modes[r].frequency_hz.value - f); });
    table.add("lost", best < 0);
    if (best < 0) continue;
    const signal::IdentifiedMode& mode = modes[best];
    table.add("sure modes", !mode.doubtful);
    table.add("doubtful", mode.doubtful);
    if (mode.doubtful) continue;
    table.add("f held, %", std::abs(mode.frequency_hz.value - f) < 1.96 * mode.frequency_hz.std);
    table.add("damping held, %", std::abs(mode.damping_ratio.value - options.damping_ratio) <
                                     1.96 * mode.damping_ratio.std);
  }
  for (std::size_t r = 0; r < taken.size(); ++r) {
    if (!taken[r]) table.add(modes[r].doubtful ? "false but doubtful" : "false sure modes", 1);
  }
}

}  // namespace
}  // namespace rigfit

int main(int argc, char** argv) {
  using namespace rigfit;
  using enum study::Of;
  study::run(study::arguments(argc, argv, 20),
             {"FRFs",
              {{"f held, %"},
               {"damping held, %"},
               {"sure modes", sum},
               {"doubtful", sum},
               {"lost", sum},
               {"false sure modes", sum},
               {"false but doubtful", sum},
               {"s a set", mean}}},
             cases(), identify);
}
