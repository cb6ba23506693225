// Which of the laws EI(T) fitted to bending tests the points favour, by AICc (stiffness_law.h).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "ident/stiffness/fitted_law.h"

namespace rigfit::ident {

/// Orders the laws, best first, and sets their Akaike weights, `decided` and `sentence`.
/// `left_out`: names of laws with more parameters than points.
void rank_laws(StiffnessLaws& result, std::size_t points, const std::vector<std::string>& left_out);

}  // namespace rigfit::ident
