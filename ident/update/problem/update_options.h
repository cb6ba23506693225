// Options of an update. The defaults suit most fits.
#pragma once

#include <vector>

#include "ident/update/pairing/mode_assignment.h"
#include "ident/update/problem/update_data.h"

namespace rigfit::ident {

struct UpdateOptions {
  /// Relative standard uncertainty of frequencies that come without one. It only sets their weight;
  /// the scatter about the fit gives the variance.
  double assumed_relative_std = 0.01;
  double assumed_damping_relative_std = 0.2;
  /// Relative standard uncertainty of FRFs that come without one; it only sets their weight.
  double assumed_frf_relative_std = 0.05;
  /// Model error, relative in FRFs, added to every line's uncertainty.
  double frf_model_relative_std = 0;
  /// Lines with a larger relative uncertainty are left out: their logarithm has no information.
  double frf_max_relative_std = 0.5;
  /// Standard uncertainty of a component of a unit shape; 0: shapes are used for pairing only.
  double shape_std = 0;
  /// Model error, relative in frequency, added to every measured uncertainty.
  double model_relative_std = 0;
  double huber_threshold = 2;  ///< standard deviations beyond which a pair pulls linearly
  AssignmentOptions assignment = {};
  /// 1: finds the answer near the scene's own values. More: fits to modes search the whole range of
  /// the parameters (update_alternatives.h), fits of FRFs that of their modes.
  int starts = 4;
  int max_iterations = 60;
  double function_tolerance = 1e-9;  ///< relative change of the cost
  int threads = 1;                   ///< work on starts in parallel
  /// True: the error of "auto" segments is subtracted from frequencies, and the rest of it adds to
  /// the uncertainties (update_segments.h). False: the data come from a model with these segments.
  bool segment_uncertainty = true;
  std::vector<UncertainInput> inputs = {};  ///< independent of each other
  /// Segments of "auto" members; FRFs get more where they need them.
  int auto_segments = 30;
  bool intervals = true;  ///< by profile where needed, and over all answers; else linear
};

}  // namespace rigfit::ident
