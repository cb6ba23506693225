// Beams near buckling, in thousands of segments, and bent through ninety degrees.
#include <cmath>
#include <string>

#include "model/linear/modal_analysis.h"
#include "tests/bench/hard_cases/hard_case.h"
#include "tests/reference/closed_forms.h"
#include "tests/scenes.h"

namespace rigfit::hard_cases {
namespace beam_area {
namespace {

using namespace model;

/// m g L^3 / EI at which a column buckles under its own weight: (9/4) j^2, j the first zero of
/// J_(-1/3) (Greenhill 1881).
constexpr double kGreenhill = 7.837347438943;

constexpr double kColumnEA = 1e8;

Scene column(double part_of_critical, int segments = 0) {
  Scene scene = testing::vertical_beam(0.75, 1, 0.3, segments);
  const double EI = 0.3 * kStandardGravity * std::pow(0.75, 3) / (kGreenhill * part_of_critical);
  scene.members[0].EI = {EI, EI};
  scene.members[0].EA = kColumnEA;
  return scene;
}

/// A column under 90 to 99.999 % of the weight that buckles it.
Outcome near_buckling(bool) {
  Worst worst;
  for (const double rest : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5}) {
    const Scene scene = column(1 - rest);
    const double EI = scene.members[0].EI[0];
    const auto truth = standing_cantilever_frequencies({0.75, 0.3, EI, 0}, 0, kStandardGravity, 2);
    const ModalAnalysis found = analyse_modes(scene, {.count = 4});
    worst.require(found.equilibrium.status == EquilibriumStatus::converged,
                  found.equilibrium.reason);
    worst.require(found.complete, "modes are missing");
    for (std::size_t i = 0; i < found.modes.size(); ++i) {
      // Its own weight of 2.2 N shortens the column by 1.1e-8 on average, with which the critical
      // weight rises two to three times as much; the axial force is known to three roundings of
      // EA. Half of both over what is left to buckling moves the frequency.
      const double weight = 0.3 * kStandardGravity * 0.75;
      const double critical = 3 * weight / (2 * kColumnEA) + 3.3e-16 * kColumnEA / weight;
      worst.add(std::abs(found.modes[i].frequency_hz / truth[i / 2] - 1),
                1.1 * found.relative_error_estimate + critical / (2 * rest) + 1e-9);
    }
  }
  return worst.outcome();
}

Outcome beyond_buckling(bool) {
  const ModalAnalysis found = analyse_modes(column(1 + 1e-5, 60));
  return refusal(found.modes.empty() && found.equilibrium.status == EquilibriumStatus::buckled,
                 found.equilibrium.reason, "buckled");
}

/// A weightless cantilever against its closed form, `count` modes of a plane.
Outcome cantilever(int segments, int count) {
  Worst worst;
  Scene scene = testing::vertical_beam(0.75, 2.1, 0.295, segments);
  scene.gravity.setZero();
  const auto truth = cantilever_frequencies({0.75, 0.295, 2.1, 0}, 0, count);
  const ModalAnalysis found = analyse_modes(scene, {.count = 2 * count});
  worst.require(found.complete, "modes are missing");
  for (std::size_t i = 0; i < found.modes.size(); ++i) {
    worst.add(std::abs(found.modes[i].frequency_hz / truth[i / 2] - 1),
              1.1 * found.relative_error_estimate + 1e-9);
  }
  return worst.outcome();
}

Outcome three_segments(bool) { return cantilever(3, 1); }
/// Rounding: 1e-16 times the highest over the lowest eigenvalue, 16 n^4 / 1.875^4.
Outcome three_thousand_segments(bool) { return cantilever(3000, 3); }

}  // namespace
}  // namespace beam_area

std::vector<HardCase> beam_cases() {
  using namespace beam_area;
  const std::string area = "beam";
  return {
      {area, "column at 90 to 99.999 % of its critical weight", "closed form within own estimate",
       near_buckling},
      {area, "column at 100.001 % of it", "refused", beyond_buckling},
      {area, "3 segments", "closed form within own estimate", three_segments},
      {area, "3000 segments", "closed form within own estimate", three_thousand_segments},
  };
}

}  // namespace rigfit::hard_cases
