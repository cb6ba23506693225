// Damage of a beam's foot from the frequencies of the beam with its cables on: 30 % of EI lost in
// the lowest 15 %, eight coupled frequencies to 0.1 %. Is the bare beam's first mode found, is the
// damage inside its interval, how often is a sound beam called damaged, and what if the foot's own
// spring is unknown? Prints a table.   pole_damage [SEEDS]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "tests/reference/damage_study.h"

int main(int argc, char** argv) {
  using namespace rigfit::reference;
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 500;
  const double sound_bare = first_in_plane_hz({0, false}), sound = first_in_plane_hz({0, true});
  fmt::print("first mode with 30 % lost: bare {:+.2f} %, coupled {:+.2f} %\n\n",
             100 * (first_in_plane_hz({0.3, false}) / sound_bare - 1),
             100 * (first_in_plane_hz({0.3, true}) / sound - 1));
  fmt::print("| {:<28} | {:>5} | {:>12} | {:>9} | {:>16} | {:>13} | {:>18} |\n", "case", "fits",
             "bare f1, %", "in 2 std", "called damaged", "median std", "smallest, 95 %");
  fmt::print("|---|---|---|---|---|---|---|\n");
  struct Case {
    const char* name;
    DamageStudy study;
  };
  DamageStudy damaged, healthy, free_shaft, soft, soft_sound;
  free_shaft.shaft_free = true;
  healthy.loss = 0;
  soft.foot_Nm_rad = soft_sound.foot_Nm_rad = 150;
  soft.foot_free = soft_sound.foot_free = true;
  soft_sound.loss = 0;
  for (const auto& one :
       {Case{"30 % lost", damaged}, Case{"sound", healthy},
        Case{"30 % lost, all EI unknown", free_shaft}, Case{"30 % lost, foot unknown", soft},
        Case{"sound, foot unknown", soft_sound}}) {
    int fits = 0, inside = 0, called = 0;
    std::vector<double> error, std;
    const double bare = first_in_plane_hz({one.study.loss, false, one.study.foot_Nm_rad});
    for (int seed = 1; seed <= seeds; ++seed) {
      const auto outcome = damage_outcome(one.study, static_cast<std::uint64_t>(seed));
      if (!outcome.converged) continue;
      ++fits;
      const auto& d = outcome.damage.damage;
      inside += std::abs(d.value - one.study.loss) <= 2 * d.std;
      called += outcome.damage.called;
      error.push_back(100 * std::abs(outcome.bare_hz / bare - 1));
      std.push_back(d.std);
    }
    if (fits == 0) continue;
    std::sort(error.begin(), error.end());
    std::sort(std.begin(), std.end());
    const auto middle = static_cast<std::size_t>(fits / 2);
    fmt::print(
        "| {:<28} | {:>5} | {:>12.3f} | {:>7.1f} % | {:>14.1f} % | {:>13.3f} | {:>18.3f} |\n",
        one.name, fits, error[static_cast<std::size_t>(0.95 * (fits - 1))], 100.0 * inside / fits,
        100.0 * called / fits, std[middle], 2 * 1.644854 * std[middle]);
  }
  fmt::print("\nbare f1: error of the bare beam's first mode, 95 % of the seeds below\n");
  return 0;
}
