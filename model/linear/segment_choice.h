// How many segments a scene needs, and what a given number costs: the error of natural frequencies
// from three numbers of segments.
//
// A frequency's error is a h^2 + b h^4 in the segment length h (second order where tension and
// bending share, fourth in a beam). One and a half times and twice as many segments (below six of
// them twice and four times) give f(0), a, b: the estimate is |f(h) - f(0)|. Finer chains are asked
// rather than coarser ones, as the estimate is then within a tenth for any order from two to six.
#pragma once

#include "model/algebra/numbers.h"
#include "model/linear/modes.h"

namespace rigfit::model {

/// Segments that a member gets at most.
inline constexpr int kMostSegments = 2000;

/// Neville's value at h = 0 of the points first..last in powers of h^2.
[[nodiscard]] double neville(const std::vector<double>& h, const std::vector<double>& f,
                             std::size_t first, std::size_t last);

/// By member: the phase (rad) that a wave of the highest of `modes` runs through on it. There must
/// be a mode.
[[nodiscard]] std::vector<double> wave_phases(const Scene& scene, const ChainModes& modes);

/// Members that say "auto" (all where `options` ask for an accuracy) get what the scene's or that
/// accuracy asks for, shared out by the phase a wave of the highest asked frequency runs through on
/// each; others keep their number. The error of what is given is estimated where `options` say so.
[[nodiscard]] ResolvedModes choose_segments(const Scene& scene, const ModesOptions& options);

}  // namespace rigfit::model
