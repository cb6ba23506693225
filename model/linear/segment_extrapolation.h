// Natural frequencies for vanishing segments, from a few short chains.
//
// A chain's frequency errs by a h^2 + b h^4 + ... in the segments' length h. Chains of 2 m, 3 m,
// 4 m, 6 m, 8 m, 12 m, ... segments a member (Bulirsch's sequence) are solved one after the other,
// modes are followed from chain to chain by their shapes, and Neville's table of the last w chains
// takes out the powers of h^2. The value given is that of w chains; its error is estimated from
// that of w + 1 chains and, as the powers are not pure where a boundary layer of bending is shorter
// than the segments, from the decrease of the last two changes: the larger counts. w is the one
// with the smallest largest error. Where the last chain changed the values by more than the
// estimate before it had said, the estimate is raised by that ratio. Source: Stoer and Bulirsch,
// Introduction to Numerical Analysis, 2.1 and 3.4.
//
// A mass clamped between two nodes of a chain breaks the series. m is chosen such that masses stand
// at nodes of every chain where their positions are multiples of 1/25 or less; where one does not,
// values are of two chains, and their error that of first order in h.
#pragma once

#include <vector>

#include "model/linear/modes.h"

namespace rigfit::model {

/// A quantity found at several segment lengths, taken to h -> 0.
struct SequenceLimit {
  double value = 0;  ///< Neville's value of the last `window` points
  double limit = 0;  ///< of one point more
  double error = 0;  ///< estimated error of `value`, same unit
};
/// `h` falling, `f` at each; at least `window` + 1 points, `window` from 1.
[[nodiscard]] SequenceLimit sequence_limit(const std::vector<double>& h,
                                           const std::vector<double>& f, std::size_t window);

/// Modes of a chain with their extrapolated frequencies.
struct ExtrapolatedModes {
  ChainModes modes;  ///< of the finest chain used; `order` by rising extrapolated frequency
  std::vector<double> frequency_hz;  ///< by ChainModes::order
  std::vector<double> limit_hz;      ///< SequenceLimit::limit, likewise
  double relative_error = 0;         ///< estimated, of `frequency_hz`, largest of all
  std::vector<int> segments;         ///< of that chain, by member
  bool known = false;  ///< false: a chain found no equilibrium or a mode could not be followed
};

/// What `extrapolate_modes` starts from.
struct SequenceStart {
  std::vector<int> first;  ///< m above, by member
  bool regular = true;     ///< all masses stand at nodes
  bool resolved = true;    ///< layers of bending by the first chain; no compression near buckling
};
/// By the phases of the highest mode's wave, by the bending at clamps and masses, whose layer of
/// length sqrt(EI / T) the first chain's segments are to resolve, and by the masses' places.
/// `modes`: of any chain.
[[nodiscard]] SequenceStart sequence_start(const Scene& scene, const ChainModes& modes);

/// Chains are added until the estimate meets `accuracy` (relative) or a member has 2000 segments;
/// the chain with the smallest estimate is kept. Uses of `options`: those of find_modes.
[[nodiscard]] ExtrapolatedModes extrapolate_modes(const Scene& scene, const ModesOptions& options,
                                                  const SequenceStart& start, double accuracy);

}  // namespace rigfit::model
