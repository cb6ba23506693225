// Slope of a load-deflection table of some 40 rows a stroke at most. Inside of bending_analysis.
//
//   load = offset of the stroke + K x
//
// Least squares over all strokes, K common; the noise is what the residuals show on
// rows - strokes - 1 degrees of freedom.
// Rows off a robust line (Theil and Sen) that three quarters share, a stop or a toe, are left out
// where the others are straight. Two things then stand against the line: one row that lies off the
// line through all others (its deleted studentised residual, times the number of rows), and a
// parabola that all strokes share (F-test; of the load over the deflection, and of the deflection
// over the load, which shows a stop). The more probable one is taken while it has a
// probability under 1 %: the row is left out, or the table is curved; more than one row in four
// left out are no line. Source: Draper and Smith, Applied Regression Analysis, 6.1 and 8. Loading
// and unloading that lie apart show wire friction, which stiffens the strand after every turn: each
// stroke then loses its first part, and the change that this makes counts as uncertainty. Strokes
// that differ are groups (estimation/groups.h).
//
// Before it, the strokes of a record: spikes, where it turns, how noisy it is, and the straight
// part of a stroke (bending_strokes.cc).
#pragma once

#include "ident/statistics/numbers.h"

namespace rigfit::ident {

/// Where loading and unloading lie apart, this share of a stroke's travel after its turn is not
/// used. A transient of any of Dahl's laws then leaves at most twice the change of the slope by
/// this.
inline constexpr double kFrictionShare = 0.35;

/// Rows in the order they were taken.
struct TableStroke {
  bool loading = true;
  VectorXd x_m, load_N;
  std::vector<char> used;  ///< 0: left out before
  std::vector<int> off;    ///< samples far off the others of their average, not in it; or empty
};

struct TableLine {
  bool usable = false;  ///< three rows and one degree of freedom at least, K positive
  double slope_N_m = 0, slope_std_N_m = 0;  ///< K
  double degrees_of_freedom = 0;
  std::vector<std::vector<char>> used;  ///< by stroke and row
  bool strokes_differ = false;          ///< slopes of strokes, at 5 %
  int left_out = 0;                     ///< rows off the line
  bool too_many_off = false;            ///< more of them than one in four: there is no line
  double friction_N_m = 0;              ///< change of K by leaving the turns out: its std
  double hysteresis_N = 0;    ///< half the distance of loading and unloading; 0: none seen
  bool curved = false;        ///< a parabola explains it significantly better
  double curvature = 0;       ///< relative change of slope over the range, of the rows used
  double curvature_half = 0;  ///< half-width of its 95 % interval; infinite: cannot be told
};

struct StrokeRange {
  Index first, last;  ///< inclusive
  int direction;      ///< sign of the deflection's change
};

/// Strokes of fewer samples are analysed row by row: the noise is not seen from row to row.
inline constexpr Index kShortStroke = 40;

/// Runs of one direction: a turn counts when the signal has come back by `least`.
[[nodiscard]] std::vector<StrokeRange> find_strokes(const VectorXd& deflection, double least);

/// Standard deviation of the noise of one sample, from second differences, which a smooth signal
/// hardly has; 0 under 20 samples.
[[nodiscard]] double sample_noise(const VectorXd& x);

/// The step to which the values of a table were read: the largest number of which all are
/// multiples. Values that change from row to row by no more than that (a quarter of them, or more)
/// were set: 0. Where they were `read` all the same, as evenly as the other channel was set: the
/// largest 1, 2 or 5 times a power of ten of which they are multiples.
[[nodiscard]] double read_step(const VectorXd& values, bool read);

/// The samples of a stroke, or `averaged` over as many that 40 remain, without those that lie eight
/// robust standard deviations off the others of their average.
[[nodiscard]] TableStroke rows_of(const StrokeRange& run, const VectorXd& x, const VectorXd& load,
                                  bool averaged);

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
[[nodiscard]] std::vector<Index> find_spikes(const VectorXd& channel);

/// `averaged`: rows are averages of a record, whose ends are left out already. `rounding_N`: std of
/// a row by the steps to which it was read; the noise is no less.
[[nodiscard]] TableLine fit_table_line(const std::vector<TableStroke>& strokes, bool averaged,
                                       double rounding_N);

}  // namespace rigfit::ident
