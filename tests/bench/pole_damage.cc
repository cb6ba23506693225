// Damage of a beam's foot from the frequencies of the beam with its cables on: 30 % of EI lost in
// the lowest 15 %, eight coupled frequencies to 0.1 %. Is the bare beam's first mode found, is the
// damage inside its interval, how often is a sound beam called damaged, and what if the foot's own
// spring is unknown? The last rows give each case more modes or better frequencies. The fit's own
// standard uncertainty of the bare mode is the Cramer-Rao bound at its estimate: the frequencies
// are normal and the fit weighs them by their variance. Prints a table.   pole_damage [SEEDS]
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
  fmt::print(
      "| case | fits | bare f1: rms error, % | bound, % | mean error / bound | below, 95 % | in "
      "1.96 bounds, % | damage in 2 std, % | called damaged, % | median std | smallest, 95 % |"
      "\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  struct Case {
    const char* name;
    DamageStudy study;
  };
  DamageStudy damaged, healthy, free_shaft, soft, soft_sound, sharp, more;
  free_shaft.shaft_free = true;
  healthy.loss = 0;
  soft.foot_Nm_rad = soft_sound.foot_Nm_rad = 150;
  soft.foot_free = soft_sound.foot_free = true;
  soft_sound.loss = 0;
  sharp.relative_std = 5e-4;
  more.modes = 16;
  for (const auto& one :
       {Case{"30 % lost", damaged}, Case{"sound", healthy},
        Case{"30 % lost, all EI unknown", free_shaft}, Case{"30 % lost, foot unknown", soft},
        Case{"sound, foot unknown", soft_sound}, Case{"30 % lost, 0.05 %", sharp},
        Case{"30 % lost, 16 modes", more}}) {
    int fits = 0, inside = 0, called = 0, held = 0;
    std::vector<double> error, std, bound;
    double sum = 0, squares = 0;
    const double bare = first_in_plane_hz({one.study.loss, false, one.study.foot_Nm_rad});
    for (int seed = 1; seed <= seeds; ++seed) {
      const auto outcome = damage_outcome(one.study, static_cast<std::uint64_t>(seed));
      if (!outcome.converged) continue;
      ++fits;
      const auto& d = outcome.damage.damage;
      inside += std::abs(d.value - one.study.loss) <= 2 * d.std;
      called += outcome.damage.called;
      const double off = 100 * (outcome.bare_hz / bare - 1);
      error.push_back(std::abs(off));
      sum += off;
      squares += off * off;
      bound.push_back(100 * outcome.bare_std_hz / bare);
      held += std::abs(off) <= 1.96 * bound.back();
      std.push_back(d.std);
    }
    if (fits == 0) continue;
    std::sort(error.begin(), error.end());
    std::sort(std.begin(), std.end());
    std::sort(bound.begin(), bound.end());
    const auto middle = static_cast<std::size_t>(fits / 2);
    const double percent = 100.0 / fits;
    fmt::print(
        "| {} | {} | {:.3f} | {:.3f} | {:+.2f} | {:.3f} | {:.1f} | {:.1f} | {:.1f} | {:.3f} | "
        "{:.3f} |\n",
        one.name, fits, std::sqrt(squares / fits), bound[middle], sum / fits / bound[middle],
        error[static_cast<std::size_t>(0.95 * (fits - 1))], held * percent, inside * percent,
        called * percent, std[middle], 2 * 1.644854 * std[middle]);
    std::fflush(stdout);
  }
  fmt::print(
      "\nbare f1: the bare beam's first mode as predicted; bound: median of its standard "
      "uncertainty\n");
  return 0;
}
