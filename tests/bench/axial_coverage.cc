// How often 95 % intervals of EA and of the damping ratio hold the truth, over hanging-mass rigs
// whose records come from finite elements with frame, adapter, mains hum and pendulum that nobody
// told the estimator of (but where the row says so; tests/reference/axial_rig.h). Prints a Markdown
// table; the first argument is the number of campaigns a cell (100), the second a part of the
// cases' names.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/reference/axial_study.h"

namespace {

using rigfit::reference::AxialStudy;

struct Case {
  const char* name;
  double frame, adapter, hum, pendulum, noise, frame_told = 0;
};

void row(const Case& one, const std::vector<double>& lengths, int campaigns) {
  AxialStudy study;
  study.rig.frame_N_m = one.frame, study.rig.adapter_N_m = one.adapter;
  study.rig.hum_N = one.hum, study.rig.pendulum_rad = one.pendulum, study.rig.noise_N = one.noise;
  study.lengths_m = lengths;
  study.frame_told_relative_std = one.frame_told;
  const auto c = rigfit::reference::axial_coverage(study, campaigns, 11);
  const double given = std::max(1, c.campaigns - c.refused);
  std::printf("| %s | %zu | %.2f | %.0f | %+.2f | %.0f | %.0f | %.0f | %d | %.0f |\n", one.name,
              lengths.size(), 100 * c.relative_std, 100 * c.covered / given, c.bias,
              100 * c.warned / given, 100 * c.silently_wrong / given,
              100 * c.damping_covered / given, c.refused, 1e3 * c.seconds / c.campaigns);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int campaigns = argc > 1 ? std::max(2, std::atoi(argv[1])) : 100;
  const std::string part = argc > 2 ? argv[2] : "";
  std::printf("%d campaigns a row, 3 taps a length\n\n", campaigns);
  std::printf(
      "| rig | lengths | std of EA %% | EA covered %% | bias / std | warned %% | missed without "
      "warning %% | damping covered %% | refused | ms |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  const Case cases[] = {
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
  for (const auto& one : cases) {
    if (std::string(one.name).find(part) == std::string::npos) continue;
    row(one, {1.0}, campaigns);
    row(one, {0.7, 1.3}, campaigns);
    row(one, {0.7, 1.0, 1.3}, campaigns);
  }
  return 0;
}
