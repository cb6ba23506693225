// Records, options and result of a bending test (bending_analysis.h).
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "ident/bending/bending_equation.h"

namespace rigfit::ident {

/// One record at one tension, SI, samples in order of time. Rows with NaN are left out and counted.
/// For a beam without tension `tension_N` may be empty.
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
  double tension_zero_std_N = 0;  ///< std of the tension cell's zero, N
  // Noise of one sample; 0: estimated from the record (second differences; residuals of a short
  // table).
  double load_noise_N = 0;
  double deflection_noise_m = 0;
  /// Stiffness of each clamp, N m/rad; 0: rigid. 1 over it is the standard uncertainty of its
  /// flexibility.
  double clamp_stiffness_Nm_rad = 0;
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
};

struct BendingFinding {
  std::string code;  ///< "toe", "stop", "clamp_slip", "curved", "set", "missing" ...
  std::string message;
  bool refuses = false;  ///< true: no EI is given because of it
};

struct BendingTestResult {
  bool refused = false;
  BeamEnds ends = BeamEnds::tensioned;  ///< from the options; tensions are zero unless `tensioned`
  std::vector<BendingFinding> findings;
  signal::Estimate tension_N;  ///< mean over the samples used; std from calibration
  double tension_low_N = 0, tension_high_N = 0;  ///< over the samples used
  /// Standard uncertainty of the tension at which EI holds, within the strokes.
  double tension_spread_N = 0;
  signal::Estimate compliance_m_N;  ///< 1/K, calibration included
  double degrees_of_freedom = 0;    ///< for the compliance; 0: many
  std::vector<BendingStroke> strokes;
  double hysteresis_N = 0;  ///< half the distance between loading and unloading lines
  double load_noise_N = 0, deflection_noise_m = 0;  ///< as used
  StiffnessFromBending stiffness;                   ///< solved only when not refused
};

}  // namespace rigfit::ident
