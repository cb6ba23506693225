// What EI(T) from bending tests is known to, as inputs of a fit (ident/update): the same terms move
// EI in all states, so that their covariance is kept.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ident/stiffness/stiffness_curve.h"
#include "ident/update/model_update.h"

namespace rigfit::ident {

/// EI of one state that was taken from the curve.
struct StiffnessUse {
  int state = 0;
  std::string parameter;  ///< parameter of the state's scene, such as "cable.EI"
  double tension_N = 0;
};

/// One input a term of the curve's uncertainty that moves any of them; empty where none is known.
[[nodiscard]] std::vector<UncertainInput> stiffness_inputs(const StiffnessCurve& curve,
                                                           const std::vector<StiffnessUse>& uses);

}  // namespace rigfit::ident
