// Damage of a beam's foot from the frequencies of the beam with its cables on: 30 % of EI lost in
// the lowest 15 %, eight coupled frequencies to 0.1 %. Is the bare beam's first mode found, is the
// damage inside its interval, how often is a sound beam called damaged, and what if the foot's own
// spring is unknown? The bound, the fit's own standard uncertainty of the bare mode, is that of
// Cramer and Rao at its estimate: the frequencies are normal and the fit weighs them by their
// variance.
#include "tests/bench/study.h"
#include "tests/reference/damage_study.h"

namespace {

using namespace rigfit;

struct Case {
  const char* name;
  reference::DamageStudy test;
  double bare_hz =
      reference::first_in_plane_hz({test.loss, false, test.foot_Nm_rad});  ///< the truth
};

void estimate(const Case& one, std::uint64_t seed, study::Table& table) {
  const auto outcome = damage_outcome(one.test, seed);
  table.add("no answer", !outcome.converged);
  if (!outcome.converged) return;
  const auto& damage = outcome.damage.damage;
  const double error = outcome.bare_hz - one.bare_hz;
  table.add("f1: rms error, %", 100 * error / one.bare_hz);
  table.add("bound, %", 100 * outcome.bare_std_hz / one.bare_hz);
  table.add("mean error / bound", error / outcome.bare_std_hz);
  table.add("f1 held, %", std::abs(error) <= 1.96 * outcome.bare_std_hz);
  table.add("damage held, %", std::abs(damage.value - one.test.loss) <= 2 * damage.std);
  table.add("called damaged, %", outcome.damage.called);
  table.add("median std of damage", damage.std);
}

}  // namespace

int main(int argc, char** argv) {
  using enum study::Of;
  const Case cases[] = {{"30 % lost", {}},
                        {"sound", {.loss = 0}},
                        {"30 % lost, foot unknown", {.foot_Nm_rad = 150, .foot_free = true}}};
  study::run(study::arguments(argc, argv, 500),
             {"case",
              {{"no answer", sum},
               {"f1: rms error, %", rms},
               {"bound, %", median},
               {"mean error / bound", mean, "{:+.2f}"},
               {"f1 held, %"},
               {"damage held, %"},
               {"called damaged, %"},
               {"median std of damage", median}}},
             cases, estimate);
}
