// Analyses a bending test: from load, deflection and tension of a clamped, tensioned cable loaded
// at mid-span to the slope d/Q and EI.
//
//   Q = c + K (d - d0) g(P),   g(P) = compliance(EI, mean P) / compliance(EI, P)
//
// K, the stiffness at the mean tension, is the slope of a straight line in x = (d - d0) g. The
// factor g corrects for the change of tension under load; it hardly depends on EI, which is
// iterated. Each stroke (loading, unloading) has its own offset c, as wire friction shifts them
// apart. Strokes of 40 samples and more become 40 averages, of which the straight part is used
// (bending_strokes.cc): a toe, yield or a stop are left out. The line, its curvature, rows off it,
// friction and strokes that differ: table_line.h. Degrees of freedom after Welch and Satterthwaite
// (GUM G.4). `stiffness_from_compliance` then gives EI.
//
// Without tension (`ends` clamped, pinned or cantilever) the tension of a record is not used, and
// EI = L^3 / (c s).
#pragma once

#include "ident/bending/bending_equation.h"
#include "ident/statistics/finding.h"

namespace rigfit::ident {

/// One record at one tension, SI, samples in order of time. Rows with NaN are left out and counted.
/// For a beam without tension `tension_N` may be empty.
struct BendingRecord {
  VectorXd tension_N, load_N, deflection_m;
};

struct BendingTestOptions {
  Estimate span_m;
  BeamEnds ends = BeamEnds::tensioned;
  // Relative standard uncertainties of calibration, common to all samples of a channel.
  double load_calibration_std = 0;
  double deflection_calibration_std = 0;
  double tension_calibration_std = 0;
  double tension_zero_std_N = 0;  ///< std of the tension cell's zero, N
  /// Stiffness of each clamp, N m/rad; 0: rigid. 1 over it is the standard uncertainty of its
  /// flexibility.
  double clamp_stiffness_Nm_rad = 0;
};

struct BendingTestResult {
  bool refused = false;
  BeamEnds ends = BeamEnds::tensioned;  ///< from the options; tensions are zero unless `tensioned`
  std::vector<Finding> findings;        ///< "toe", "stop", "clamp_slip", "curved", "missing" ...
  Estimate tension_N;                   ///< mean over the samples; std from calibration
  /// Standard uncertainty of the tension at which EI holds, within the strokes.
  double tension_spread_N = 0;
  Estimate compliance_m_N;         ///< 1/K, calibration included
  double degrees_of_freedom = 0;   ///< for the compliance; 0: many
  double hysteresis_N = 0;         ///< half the distance between loading and unloading lines
  StiffnessFromBending stiffness;  ///< solved only when not refused
};

/// Throws std::invalid_argument for channels of different lengths or a span that is not positive.
[[nodiscard]] BendingTestResult analyse_bending_test(const BendingRecord& record,
                                                     const BendingTestOptions& options);

/// Splits a table of points taken at several tensions into one record per tension: clusters that
/// are more than 5 % of the tension and more than their own spread apart.
[[nodiscard]] std::vector<BendingRecord> split_by_tension(const BendingRecord& table);

}  // namespace rigfit::ident
