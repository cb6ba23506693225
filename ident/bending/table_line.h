// Slope of a load-deflection table of few rows (strokes under 40 rows), where noise cannot be seen
// from row to row. Inside of bending_analysis.
//
//   load = offset of the stroke + K x
//
// Least squares over all strokes, K common; the noise is what the residuals show on
// rows - strokes - 1 degrees of freedom, and no less than the resolution of the numbers
// (half-widths of a last digit, variance r^2 / 12) as long as the residuals do not contradict it.
// Rows off a robust line (Theil and Sen) that three quarters share, a stop or a toe, are left out
// where the others are straight. Two things then stand against the line: one row that lies off the
// line through all others (its deleted studentised residual, times the number of rows), and a
// parabola that all strokes share (F-test; of the load over the deflection, and of the deflection
// over the load, which shows a stop). The more probable one is taken while it has a probability
// under 1 %: the row is left out, or the table is curved; more than one row in four left out are no
// line. Source: Draper and Smith, Applied Regression Analysis, 6.1 and 8. Loading and unloading
// that lie apart show wire friction, which stiffens the strand after every turn: each stroke then
// loses its first quarter, and the change that this makes counts as uncertainty.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "signal/numerics/estimate.h"

namespace rigfit::ident {

/// Rows in the order they were taken.
struct TableStroke {
  bool loading = true;
  Eigen::VectorXd x_m, load_N;
};

struct TableLine {
  bool usable = false;  ///< three rows and one degree of freedom at least, K positive
  double slope_N_m = 0, slope_std_N_m = 0;  ///< K
  double degrees_of_freedom = 0;
  std::vector<signal::Estimate> stroke_slopes;  ///< with the common noise; NaN under two rows
  std::vector<double> offsets_N;
  std::vector<std::vector<char>> used;  ///< by stroke and row
  double noise_N = 0;                   ///< standard deviation about the line, as used
  double residual_N = 0;                ///< as the residuals show it
  bool strokes_differ = false;          ///< slopes of strokes, at 5 %
  int left_out = 0;                     ///< rows off the line
  bool too_many_off = false;            ///< more of them than one in four: there is no line
  double friction_std_N_m = 0;          ///< of K, included: what leaving the turns out changes
  double hysteresis_N = 0;    ///< half the distance of loading and unloading; 0: none seen
  bool curved = false;        ///< a parabola explains it significantly better
  double curvature = 0;       ///< relative change of slope over the range, of the rows used
  double curvature_half = 0;  ///< half-width of its 95 % interval; infinite: cannot be told
};

/// `resolution_std_N`: of the numbers, as a standard deviation of the load about the line;
/// `noise_std_N`: stated noise, kept whatever the residuals show.
[[nodiscard]] TableLine fit_table_line(const std::vector<TableStroke>& strokes,
                                       double resolution_std_N, double noise_std_N);

/// Last digit of numbers that are multiples of a power of ten times `unit` (1000 steps of it over
/// their range at most), such as 0.01 for 0.21, 0.42, 0.65. 0 where they have more digits, and
/// where they rise in equal steps: those were set, not read.
[[nodiscard]] double resolution_of(const Eigen::VectorXd& values, double unit);

}  // namespace rigfit::ident
