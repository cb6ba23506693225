// EI(T) of a virtual strand from bending tests at four tensions, over seeds: how often the curve's
// 95 % interval holds the truth, where EI is that of the tension at rest or follows the tension of
// the moment. The load raises the tension of the lowest test by some 10 %.
#pragma once

#include <array>
#include <cmath>
#include <string>

#include "ident/campaign/single_tests/bending_campaign.h"
#include "ident/virtual_rig/sensor_model.h"
#include "ident/virtual_rig/virtual_bench.h"

namespace rigfit::ident::simulated {

inline constexpr std::array<double, 4> kCurveTensions{25, 100, 200, 300};

/// By tension; `held` of `curves`.
struct CurveCoverage {
  int curves = 0;
  std::array<int, 4> held{};
};

inline double strand_EI(double T) { return 0.08 + 0.042 * std::sqrt(T); }

inline CurveCoverage curve_coverage(bool of_the_moment, int seeds, int first = 1) {
  CurveCoverage coverage;
  const VirtualInstruments instruments;
  for (int seed = first; seed < first + seeds; ++seed) {
    BendingCampaign campaign{.test = {.span_m = {0.5, 0.0005}}};
    campaign.test.tension_zero_std_N = instruments.tension_cell.offset_std;
    Random draws = random_stream(static_cast<std::uint64_t>(seed), 77);
    const double span = 0.5 + 0.0005 * std::normal_distribution<double>()(draws);
    for (const double T : kCurveTensions) {
      Random random =
          random_stream(static_cast<std::uint64_t>(seed), static_cast<std::uint64_t>(T));
      const auto record =
          virtual_bending_record({.EI_Nm2 = strand_EI(T),
                                  .EI_by_tension_m2 = of_the_moment ? 0.021 / std::sqrt(T) : 0,
                                  .span_m = span,
                                  .tension_N = T,
                                  .peak_load_N = 4,
                                  .sample_rate_hz = 5,
                                  .tension_cell = instruments.tension_cell,
                                  .load_cell = instruments.load_cell,
                                  .lvdt = instruments.lvdt},
                                 random);
      campaign.sources.push_back(
          {std::to_string(T),
           {record.channel("tension").samples, record.channel("load").samples,
            record.channel("deflection").samples},
           {}});
    }
    const auto result = analyse_bending_campaign(campaign);
    if (result.curve.empty()) continue;
    ++coverage.curves;
    for (std::size_t i = 0; i < kCurveTensions.size(); ++i) {
      const double truth = strand_EI(kCurveTensions[i]);
      const auto at = result.curve.at(kCurveTensions[i]);
      coverage.held[i] += at.low <= truth && truth <= at.high;
    }
  }
  return coverage;
}

}  // namespace rigfit::ident::simulated
