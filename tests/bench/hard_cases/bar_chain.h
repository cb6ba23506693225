// A second algorithm for a limp cable's small motions: straight two-node bars along the exact
// elastic catenary, with the catenary's own axial force, consistent mass and dense algebra. Nothing
// is shared with the segment model but the physics; the end points are not balanced by a Newton
// method, and there is no bending. Frequencies err by the square of the bars' length; chains with
// three numbers of bars remove that and the fourth power.
#pragma once

#include <vector>

#include "tests/reference/closed_forms.h"

namespace rigfit::hard_cases {

struct BarFrequencies {
  std::vector<double> in_hz, out_hz;
  double error = 0;  ///< relative, the largest: the change from two thirds as many bars
};

[[nodiscard]] BarFrequencies bar_frequencies(const model::ElasticCatenary& cable,
                                             const model::CatenaryState& state,
                                             double mass_per_length_kg_m, int count);

}  // namespace rigfit::hard_cases
