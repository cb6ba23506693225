// How often the intervals of the axial test hold the truth, over rigs drawn from their stated
// uncertainties (axial_rig.h).
#pragma once

#include <vector>

#include "tests/reference/axial_rig.h"

namespace rigfit::reference {

struct AxialStudy {
  AxialRig rig;
  std::vector<double> lengths_m;
  int taps = 3;
  double mass_std_kg = 0.003, length_std_m = 0.001, per_length_std = 0.001;
  double frame_told_relative_std = 0;  ///< the rig's frame is told, drawn off by this; 0: not told
};

struct AxialCoverage {
  int campaigns = 0;
  int refused = 0;                    ///< no EA
  int covered = 0;                    ///< EA within its interval
  int silently_wrong = 0;             ///< missed, without any of the warnings about the lengths
  int warned = 0;                     ///< with one of these warnings
  double relative_std = 0, bias = 0;  ///< means: of std / EA, of (EA - truth) / std
};

[[nodiscard]] AxialCoverage axial_coverage(const AxialStudy& study, int campaigns, unsigned seed);

}  // namespace rigfit::reference
