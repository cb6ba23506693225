#include "tests/reference/axial_study.h"

#include <cmath>
#include <random>

#include "ident/campaign/single_tests/axial_campaign.h"

namespace rigfit::reference {

AxialCoverage axial_coverage(const AxialStudy& study, int campaigns, unsigned seed) {
  AxialCoverage sum{.campaigns = campaigns};
  for (int k = 0; k < campaigns; ++k) {
    auto random = ident::random_stream(seed, static_cast<std::uint64_t>(k));
    std::normal_distribution<double> normal;
    ident::AxialInputs inputs{.setup = {.mass_kg = {study.rig.mass_kg, study.mass_std_kg}}};
    inputs.setup.mass_per_length_kg_m = {study.rig.mass_per_length_kg_m, study.per_length_std};
    inputs.setup.length_std_m = study.length_std_m;
    AxialRig rig = study.rig;
    if (study.frame_told_relative_std > 0) {
      const double off = 1 + study.frame_told_relative_std * normal(random);
      inputs.setup.frame_stated = true;
      inputs.setup.frame_stiffness_N_m = {rig.frame_N_m * off,
                                          study.frame_told_relative_std * rig.frame_N_m * off};
    }
    rig.mass_kg += study.mass_std_kg * normal(random);
    rig.mass_per_length_kg_m += study.per_length_std * normal(random);
    for (const double length : study.lengths_m) {
      rig.length_m = length + study.length_std_m * normal(random);
      for (int tap = 0; tap < study.taps; ++tap) {
        inputs.recordings.push_back({"tap", axial_rig_record(rig, random), length});
      }
    }
    const auto result = ident::axial_campaign(inputs);
    if (!result.test) {
      ++sum.refused;
      continue;
    }
    const auto& r = *result.test;
    bool warned = false;
    for (const auto& f : result.findings) {
      for (const char* code :
           {"one_length", "lengths_too_close", "lengths_disagree", "series_compliance"}) {
        warned = warned || f.code == code;
      }
    }
    const bool in = r.EA_low_N <= study.rig.EA_N && study.rig.EA_N <= r.EA_high_N;
    sum.covered += in, sum.warned += warned, sum.silently_wrong += !in && !warned;
    sum.relative_std += r.EA_N.std / r.EA_N.value;
    sum.bias += (r.EA_N.value - study.rig.EA_N) / r.EA_N.std;
  }
  const int given = std::max(1, campaigns - sum.refused);
  sum.relative_std /= given, sum.bias /= given;
  return sum;
}

}  // namespace rigfit::reference
