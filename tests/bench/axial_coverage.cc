// How often 95 % intervals of EA and of the damping ratio hold the truth, over hanging-mass rigs
// whose records come from finite elements with frame, adapter, mains hum and pendulum that nobody
// told the estimator of (but where the row says so; tests/reference/axial_rig.h). Three taps a
// length.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "tests/bench/study.h"
#include "tests/reference/axial_study.h"

namespace {

using namespace rigfit;

struct Rig {
  const char* name;
  double frame, adapter, hum, pendulum, noise, frame_told = 0;
};

struct Case {
  std::string name;
  reference::AxialStudy study;
};

void identify(const Case& one, std::uint64_t seed, study::Table& table) {
  const auto c = reference::axial_coverage(one.study, 1, 11, seed);
  table.add("refused", c.refused);
  table.add("s", c.seconds);
  if (c.refused > 0) return;
  table.add("EA held, %", c.covered);
  table.add("bias / std", c.bias);
  table.add("std of EA, %", 100 * c.relative_std);
  table.add("warned, %", c.warned);
  table.add("missed without warning, %", c.silently_wrong);
  table.add("damping held, %", c.damping_covered);
}

}  // namespace

int main(int argc, char** argv) {
  using enum study::Of;
  const Rig rigs[] = {
      {"nothing but the cable", 0, 0, 0, 0, 1},
      {"adapter 2e6 N/m", 0, 2e6, 0, 0, 1},
      {"frame 5e6 N/m", 5e6, 0, 0, 0, 1},
      {"frame 5e6 N/m, told to 10 %", 5e6, 0, 0, 0, 1, 0.1},
      {"frame 2e7 N/m", 2e7, 0, 0, 0, 1},
      {"frame 5e7 N/m", 5e7, 0, 0, 0, 1},
      {"hum 3 N", 0, 0, 3, 0, 1},
      {"pendulum 0.1 rad", 0, 0, 0, 0.1, 1},
      {"frame 5e6, hum 3 N, pendulum 0.1 rad", 5e6, 0, 3, 0.1, 1},
      {"noise 10 N", 0, 0, 0, 0, 10},
  };
  std::vector<Case> cases;
  for (const auto& rig : rigs) {
    for (const std::vector<double>& lengths :
         {std::vector{1.0}, std::vector{0.7, 1.3}, std::vector{0.7, 1.0, 1.3}}) {
      Case& one = cases.emplace_back(fmt::format("{}; {} lengths", rig.name, lengths.size()));
      one.study.rig.frame_N_m = rig.frame, one.study.rig.adapter_N_m = rig.adapter;
      one.study.rig.hum_N = rig.hum, one.study.rig.pendulum_rad = rig.pendulum;
      one.study.rig.noise_N = rig.noise;
      one.study.lengths_m = lengths;
      one.study.frame_told_relative_std = rig.frame_told;
    }
  }
  study::run(study::arguments(argc, argv, 100, 0),
             {"rig",
              {{"refused", sum},
               {"EA held, %"},
               {"bias / std", mean, "{:+.2f}"},
               {"std of EA, %", mean},
               {"warned, %"},
               {"missed without warning, %"},
               {"damping held, %"},
               {"s", mean}}},
             cases, identify);
}
