// Strokes of a load-deflection record: spikes, where it turns, how noisy it is, and the straight
// part of a stroke. Inside of bending_analysis.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/bending/table_line.h"

namespace rigfit::ident {

struct StrokeRange {
  Eigen::Index first, last;  ///< inclusive
  int direction;             ///< sign of the deflection's change
};

/// Strokes of fewer samples are analysed row by row: the noise is not seen from row to row.
inline constexpr Eigen::Index kShortStroke = 40;

/// Runs of one direction: a turn counts when the signal has come back by `least`.
[[nodiscard]] std::vector<StrokeRange> find_strokes(const Eigen::VectorXd& deflection,
                                                    double least);

/// Standard deviation of the noise of one sample, from second differences, which a smooth signal
/// hardly has; 0 under 20 samples.
[[nodiscard]] double sample_noise(const Eigen::VectorXd& x);

/// The step to which the values of a table were read: the largest number of which all are
/// multiples. Values that change from row to row by no more than that (a quarter of them, or more)
/// were set: 0. Where they were not, as `read` says, a dial was steady by chance: the largest power
/// of ten of which they are multiples, unless they are round (1, 2 or 5 times it).
[[nodiscard]] double read_step(const Eigen::VectorXd& values, bool read);

/// The samples of a stroke, or `averaged` over as many that 40 remain, without those that lie eight
/// robust standard deviations off the others of their average.
[[nodiscard]] TableStroke rows_of(const StrokeRange& run, const Eigen::VectorXd& x,
                                  const Eigen::VectorXd& load, bool averaged);

struct StraightPart {
  double at_turn = 0, at_end = 0;  ///< share of the travel left out where the stroke begins, ends
  double share = 1;                ///< of the travel or of the load, the larger
};

/// Masks what lies before and after the straight part of a stroke: from the unloaded end the first
/// rows over a quarter of the load or more that lie within `limit` (N) of their own line, and of
/// the runs of rows that begin in their first half the one over most load. `turn`: share of the
/// travel that is left out after the turn whatever it is. False: none.
[[nodiscard]] bool leave_ends_out(TableStroke& stroke, double turn, double limit,
                                  StraightPart& part);

/// Samples of one channel (20 at least, else none) that lie off the mean of their neighbours and
/// off the straight lines through the two samples before and after, all three, by more than 12
/// robust standard deviations of that and by a twentieth of the channel's central 80 %, and not
/// between those two samples before and behind. A turn is on one of the two lines, a step too; the
/// first and the last sample, which have one neighbour, must be off by that central part: friction
/// begins with a jump.
[[nodiscard]] std::vector<Eigen::Index> find_spikes(const Eigen::VectorXd& channel);

}  // namespace rigfit::ident
