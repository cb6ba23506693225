// Whether a mode's frequency goes with the amplitude at the points of a test.
//
// A spring that softens or hardens shifts the frequency by about the squared amplitude (backbone
// curve; Worden and Tomlinson, Nonlinearity in Structural Dynamics, ch. 2). Struck with like hits,
// the points of a test vibrate as strongly as the shape says, so that on f_c = f_0 + b |R_c|^2, R_c
// the residue of point c, a line weighted by the points' errors and their scatter tells b by
// Student's t.
#pragma once

#include "signal/modal/modal_model.h"

namespace rigfit::signal {

struct AmplitudeTrend {
  double chance = 1;        ///< of as steep a line where amplitude does nothing
  double small_hz = 0;      ///< f_0: frequency at small amplitude
  double strongest_hz = 0;  ///< on the line, at the strongest point
};

/// From the mode's points, places struck one by one; chance 1 for fewer than five, or where their
/// amplitudes are equal.
[[nodiscard]] AmplitudeTrend amplitude_trend(const IdentifiedMode& mode);

}  // namespace rigfit::signal
