// Slope of a load-deflection table of few rows (strokes under 40 rows), where noise cannot be seen
// from row to row. Inside of bending_analysis.
//
//   load = offset of the stroke + K x
//
// Least squares over all strokes, K common; the noise is what the residuals show on
// rows - strokes - 1 degrees of freedom, and no less than the resolution of the numbers
// (half-widths of a last digit, variance r^2 / 12) as long as the residuals do not contradict it.
// Nothing is left out before an F-test says so: against the line stand
//   a spike      one row left out
//   a toe        the rows below some deflection left out
//   a top        the rows above some deflection left out
//   turns        the first rows of every stroke left out (wire friction)
//   a curve      a parabola, the same for all strokes
// each with as many further parameters as rows left out; the most significant one is taken when its
// probability times the number of alternatives is under 1 %. A toe or top that a parabola explains
// as well (within a factor of 10 in probability) counts as a curve. Source: Draper and Smith,
// Applied Regression Analysis, 6.1 and 8.
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

  std::vector<std::pair<std::size_t, Eigen::Index>> spikes;  ///< stroke, row
  double toe_share = 0, top_share = 0;                       ///< of the travel, left out
  int turn_rows = 0;            ///< left out at the beginning of every stroke
  double friction_std_N_m = 0;  ///< of K, included: what leaving the turns out changes
  double hysteresis_N = 0;      ///< half the distance of loading and unloading; 0: none seen

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
