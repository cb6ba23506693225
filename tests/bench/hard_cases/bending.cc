// Bending stiffness where its equation says little: limits of lambda, strands that slip freely or
// not at all.
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "ident/bending/bending_equation.h"
#include "tests/bench/hard_cases/hard_case.h"
#include "tests/reference/exact_bending_ratio.h"

namespace rigfit::hard_cases {
namespace bending_area {
namespace {

using namespace ident;

constexpr double kRounding = std::numeric_limits<double>::epsilon() / 2;

Outcome ratio_over_ten_decades(bool) {
  Worst worst;
  for (int i = 0; i <= 2000; ++i) {
    const double lambda = std::pow(10.0, -6 + i / 200.0);
    const auto truth = static_cast<double>(apps::exact_bending_ratio(lambda));
    worst.add(std::abs(bending_ratio(lambda) / truth - 1), 8 * kRounding);
    const auto rest = static_cast<double>(1 - apps::exact_bending_ratio(lambda));
    worst.add(std::abs(bending_ratio_complement(lambda) / rest - 1), 8 * kRounding);
  }
  return worst.outcome();
}

/// From EI to the compliance and back. F is good to eight roundings, there and back; with the
/// products around it 32 roundings times the sensitivity that the result states itself.
Outcome stiffness_over_ten_decades(bool) {
  Worst worst;
  const double span = 0.6, tension = 100;
  for (int i = 0; i <= 200; ++i) {
    const double lambda = std::pow(10.0, -6 + i / 20.0);
    const double EI = tension * span * span / (4 * lambda * lambda);
    const auto found = stiffness_from_compliance(
        {{midspan_compliance(EI, tension, span), 0}, {tension, 0}, {span, 0}});
    worst.require(found.status == BendingStatus::solved, "not solved: " + found.reason);
    worst.add(std::abs(found.EI_Nm2.value / EI - 1) /
                  (32 * kRounding * (1 + std::abs(found.log_sensitivity_compliance))),
              1);
  }
  return worst.outcome("of the rounding");
}

/// 95 % intervals of a slope known to 0.5 % at both bounds of the paper's strand.
Outcome bounds_of_the_strand(bool quick) {
  Coverage coverage;
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  const double span = 0.5;
  for (const double EI : {0.0306, 15.5632}) {
    for (const double tension : {25.0, 300.0}) {
      const double slope = midspan_compliance(EI, tension, span);
      for (int k = 0; k < (quick ? 25 : 150); ++k) {
        const auto found =
            stiffness_from_compliance({{slope * (1 + 0.005 * normal(random)), 0.005 * slope},
                                       {tension * (1 + 0.002 * normal(random)), 0.002 * tension},
                                       {span, 0}});
        coverage.require(found.status == BendingStatus::solved, "not solved: " + found.reason);
        coverage.add(found.EI_Nm2.value, found.EI_Nm2.std, found.low, found.high, EI);
      }
    }
  }
  return coverage.outcome();
}

}  // namespace
}  // namespace bending_area

std::vector<HardCase> bending_cases() {
  using namespace bending_area;
  const std::string area = "bending";
  return {
      {area, "equation, lambda 1e-6 to 1e4", "four units in the last place",
       ratio_over_ten_decades},
      {area, "EI back, lambda 1e-6 to 1e4", "rounding of the slope x stated sensitivity",
       stiffness_over_ten_decades},
      {area, "EI at EImin and EImax, 25 and 300 N", "95 % intervals hold the truth",
       bounds_of_the_strand},
  };
}

}  // namespace rigfit::hard_cases
