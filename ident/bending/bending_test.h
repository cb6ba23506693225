// A bending test from its records: load at mid-span of a clamped, tensioned cable, deflection and
// tension as measured, to the slope d/Q and EI.
//
//   Q = c + K (d - d0) g(P),   g(P) = compliance(EI, mean P) / compliance(EI, P)
//
// K, the stiffness at the mean tension, is the slope of a straight line in x = (d - d0) g; g takes
// out that the tension changes while the cable is loaded and hardly depends on EI, which is
// iterated. Each stroke (loading, unloading) has its own line: wire friction shifts them apart and
// bends their beginnings. Line: Deming's (errors in both channels, ratio of variances from the
// channels' own noise), Huber weights; variance from the larger of the textbook formula and a block
// jackknife, which sees that residuals of one stroke are not independent. Strokes are pooled with
// the scatter between them (DerSimonian and Laird 1986), degrees of freedom after Welch and
// Satterthwaite (GUM G.4). Where strokes have 40 samples or more the slope is averaged over what
// wire friction may do after the turns (friction_transient.h), with the spread between its laws in
// the uncertainty. Then `stiffness_from_compliance`.
//
// Without tension (`ends` clamped, pinned or cantilever) the tension of a record is not used, the
// straight part of long strokes is the elastic one between toe and yield or stop
// (beam_segments.h), and EI = L^3 / (c s) (beam_ends.h).
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "ident/bending/beam_ends.h"
#include "ident/bending/bending_equation.h"

namespace rigfit::ident {

/// One record at one tension, SI, samples in the order of time. NaN rows are left out and counted.
/// Without tension `tension_N` may be empty.
struct BendingRecord {
  Eigen::VectorXd tension_N, load_N, deflection_m;
};

struct BendingTestOptions {
  signal::Estimate span_m;
  BeamEnds ends = BeamEnds::tensioned;
  // Relative standard uncertainties of calibration, common to all samples of a channel.
  double load_calibration_std = 0;
  double deflection_calibration_std = 0;
  double tension_calibration_std = 0;
  double tension_zero_std_N = 0;  ///< of the tension cell's zero, N
  // Noise of one sample; 0: estimated from the record (second differences; residuals of a short
  // table).
  double load_noise_N = 0;
  double deflection_noise_m = 0;
  /// After every turn friction first changes sign: this share of a stroke's travel is not used
  /// (strokes of 20 samples and more).
  double turn_share = 0.15;
  /// Where the local median over a twentieth of a stroke leaves the line by more than this share of
  /// the load range (and four times its noise), toe, stop or slip begin.
  double straightness = 0.005;
  /// Relative change of slope over the straight part: above the first it is warned of, above the
  /// second there is no one EI and the test is refused.
  double curvature_warning = 0.05, curvature_refusal = 0.25;
  /// Part of a stroke's deflection that must remain straight.
  double least_straight_share = 0.4;
};

struct BendingStroke {
  bool loading = true;
  Eigen::Index first = 0, last = 0;  ///< samples of the record (after NaN rows), whole stroke
  Eigen::Index used_first = 0, used_last = 0;  ///< the straight part
  signal::Estimate stiffness_N_m;              ///< K of this stroke, at the mean tension
  double offset_N = 0;                         ///< c
  double residual_rms_N = 0;
  double curvature = 0;  ///< relative change of slope over the straight part
  double curvature_std = 0;
  int load_drops = 0;  ///< stick-slip: sudden losses of load against the stroke
};

struct BendingFinding {
  std::string code;  ///< "toe", "stop", "stick_slip", "clamp_slip", "curved", "set", "missing" ...
  std::string message;
  bool refuses = false;  ///< there is no EI because of it
};

struct BendingTestResult {
  bool refused = false;
  BeamEnds ends = BeamEnds::tensioned;  ///< as asked; otherwise the tensions are zero
  std::vector<BendingFinding> findings;
  signal::Estimate tension_N;  ///< mean over the samples used; std from calibration
  double tension_low_N = 0, tension_high_N = 0;  ///< over the samples used
  /// Standard uncertainty of the tension that EI belongs to (tension_spread.h), over the strokes.
  double tension_spread_N = 0;
  signal::Estimate compliance_m_N;  ///< 1/K, calibration included
  double degrees_of_freedom = 0;    ///< of the compliance; 0: many
  std::vector<BendingStroke> strokes;
  signal::Estimate loading_stiffness_N_m, unloading_stiffness_N_m;  ///< NaN: no such stroke
  double hysteresis_N = 0;  ///< half the distance between loading and unloading lines
  double load_noise_N = 0, deflection_noise_m = 0;  ///< as used
  /// Relative standard uncertainty of K from the strokes, friction included, calibrations left out.
  double relative_std_strokes = 0;
  // Wire friction after the turns, averaged over its laws; zero where strokes are too short to
  // tell.
  double friction_probability = 0;          ///< Akaike weight of the laws with friction
  double friction_travel_m = 0;             ///< over which it turns round; 0: none is seen
  double friction_load_N = 0;               ///< half of what it adds after a turn
  double relative_std_friction = 0;         ///< of K: what the laws differ by
  double relative_friction_correction = 0;  ///< of K, against straight lines
  StiffnessFromBending stiffness;           ///< solved only when not refused
};

/// Throws std::invalid_argument for channels of different lengths or a span that is not positive.
[[nodiscard]] BendingTestResult analyse_bending_test(const BendingRecord& record,
                                                     const BendingTestOptions& options);

/// Splits a table of points taken at several tensions into one record a tension: clusters of the
/// tension separated by more than 5 % of it and by more than their own spread.
[[nodiscard]] std::vector<BendingRecord> split_by_tension(const BendingRecord& table);

}  // namespace rigfit::ident
