// How many segments a scene needs, and what a given number costs: the error of natural frequencies
// from three numbers of segments.
//
// A frequency's error is a h^2 + b h^4 in the segment length h (second order in general; the
// accurate rotary inertia makes a vanish where tension dominates). Three resolutions give f(0), a,
// b: the estimate is |f(h) - f(0)|, honest in either case.
#pragma once

#include <vector>

#include "model/modes.h"

namespace rigfit::model {

struct ResolutionError {
  double relative = 0;                  ///< largest of all modes of `modes`
  std::vector<double> extrapolated_hz;  ///< by ChainModes::order
  bool known = false;  ///< false: a coarser or finer chain found no equilibrium or fewer modes
};

/// `segments` by member: those of `modes`.
[[nodiscard]] ResolutionError resolution_error(const Scene& scene, const ModesOptions& options,
                                               const ChainModes& modes,
                                               const std::vector<int>& segments);

struct SegmentChoice {
  std::vector<int> segments;  ///< by member
  ChainModes modes;
  ResolutionError error;
};

/// Members that say "auto" get what the scene's accuracy asks for, shared out by the phase a wave
/// of the highest asked frequency runs through on each; others keep their number.
[[nodiscard]] SegmentChoice choose_segments(const Scene& scene, const ModesOptions& options);

}  // namespace rigfit::model
