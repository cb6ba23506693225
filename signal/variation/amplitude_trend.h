// Whether a mode's frequency goes with its amplitude, and what it is at small amplitude.
//
// A spring that softens or hardens shifts the frequency by about the squared amplitude (backbone
// curve; Worden and Tomlinson, Nonlinearity in Structural Dynamics, ch. 2). Hits of impulse J at
// point c move a mode as J |L_c|, L_c its participation there (strongest 1), so that its
// frequencies lie on
//   f = f_0 + b x,   x = (J |L_c|)^2.
// Where points were hit several times, b comes from the hits of each point about their mean and f_0
// from the mean over hits and points; where once, both from the line over points, their own errors
// and a random scatter about it (point_tracks.h). Student's t tells whether b is more than chance.
//
// Limits: friction, gaps and joints shift the frequency by other powers of the amplitude than the
// second; hits that are alike in size tell nothing; a mode that others shift (cross terms) goes
// with the size of the hits all the same.
#pragma once

#include <optional>
#include <vector>

#include "signal/numerics/estimate.h"

namespace rigfit::signal {

/// What one hit on a point gave of a mode.
struct ValueOfHit {
  std::size_t point = 0;
  double amplitude = 0;  ///< J |L_c|, or |L_c| where sizes are not known
  Estimate value;        ///< frequency, or what else may go with amplitude; own error, 0: not known
};

struct AmplitudeTrend {
  double chance = 1;     ///< of as steep a line where amplitude does nothing
  Estimate small;        ///< at small amplitude; +-1.96 std hold 95 %
  Estimate slope;        ///< b
  double strongest = 0;  ///< on the line, at the strongest amplitude
};

/// Nothing for fewer than three hits of one point (in sum over points one degree of freedom less
/// than hits beyond the first), for fewer than five points hit once, or where amplitudes are equal.
[[nodiscard]] std::optional<AmplitudeTrend> amplitude_trend(const std::vector<ValueOfHit>& values);

}  // namespace rigfit::signal
