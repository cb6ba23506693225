// How many segments a scene needs, what a given number costs, and natural frequencies for vanishing
// segments.
//
// The error of given segments (choose_segments) is a h^2 + b h^4 in the segment length h (second
// order where tension and bending share, fourth in a beam). One and a half times and twice as many
// segments (below six of them twice and four times) give f(0), a, b: the estimate is |f(h) - f(0)|.
// Finer chains are asked rather than coarser ones, as the estimate is then within a tenth for any
// order from two to six.
//
// Extrapolation to vanishing segments starts from a few short chains.
// A chain lumped by RotaryInertia::even_powers errs by a h^2 + b h^4 + ... in the segments' length
// h. Chains of 2 m, 3 m, 4 m, 6 m, 8 m, 12 m, ... segments (Bulirsch's sequence) are solved one
// after the other, modes are followed from chain to chain by their shapes, and Neville's table of
// the last w chains takes out the powers of h^2. Source: Stoer and Bulirsch, Introduction to
// Numerical Analysis, 2.1 and 3.4.
//
// A member is cut into stretches of even segments, whose numbers all grow alike from chain to
// chain, so that the series stays one in h^2: stretches end where masses are attached, and where a
// layer of bending, sqrt(EI / T) deep, has decayed that a clamp or a mass makes.
//
// The value given is that of w chains, v_w. Its error is e = |v_w - v_(w+1)| and what v_(w+1) errs
// itself, taken as twice u = |v_(w+1) - v_(w+2)|. With u <= e / 3, and as long as v_(w+1) errs by
// no more than that, e + 2 u lies between one and five times the error, between one and 2.5 times
// where v_(w+1) errs by u at most. w is the one of the smallest such estimate.
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

/// A quantity found at several segment lengths, taken to h -> 0.
struct SequenceLimit {
  double value = 0;      ///< Neville's value of the last `window` points, v_w above
  double limit = 0;      ///< Neville's value with one point more
  double error = 0;      ///< estimated, of `value`, same unit
  bool certain = false;  ///< u <= e / 3
};
/// `h` falling, `f` at each; at least `window` + 2 points, `window` from 1.
[[nodiscard]] SequenceLimit sequence_limit(const std::vector<double>& h,
                                           const std::vector<double>& f, std::size_t window);

/// Even segments up to a place on a member.
struct Stretch {
  double end = 1;    ///< 0..1 of the unstretched length
  int segments = 1;  ///< m above
};

/// What `extrapolate_modes` starts from.
struct SequenceStart {
  std::vector<std::vector<Stretch>> stretches;  ///< by member, from its first node on
  std::vector<int> samples;                     ///< places by member at which shapes are compared
  bool resolved = true;                         ///< false: a member in compression near buckling
  /// The chain of `factor` times the segments.
  [[nodiscard]] ChainOptions chain(int factor, const ModesOptions& options) const;
};
/// By the phases of the highest mode's wave, the layers of bending at clamps, masses and sagging
/// pinned ends (where they change omega^2 by more than a tenth of `accuracy`, relative) and the
/// masses' places. `modes`: of any chain.
[[nodiscard]] SequenceStart sequence_start(const Scene& scene, const ChainModes& modes,
                                           double accuracy);

/// Chains are added until the estimate meets `accuracy` (relative) or a member has 2000 segments;
/// the finest is kept: where shapes or damping are asked for, of a fifth of a radian a segment at
/// most. Uses of `options`: those of find_modes but `rotary_inertia`. Not `known` where a chain
/// finds no equilibrium or a mode cannot be followed.
[[nodiscard]] ResolvedModes extrapolate_modes(const Scene& scene, const ModesOptions& options,
                                              const SequenceStart& start, double accuracy);

/// The modes that an analysis is made of: extrapolated where `options` ask for an accuracy or every
/// member leaves its segments to the program; of one chain (choose_segments) where a member has
/// its number, and where short chains do not follow the powers of their segments' length (a column
/// that buckles when cut coarsely).
[[nodiscard]] ResolvedModes resolve_modes(const Scene& scene, const ModesOptions& options);

}  // namespace rigfit::model
