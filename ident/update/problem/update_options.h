// Options of an update. The defaults suit most fits.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "ident/update/pairing/mode_assignment.h"
#include "ident/update/pairing/mode_pairing.h"
#include "ident/update/problem/update_data.h"
#include "model/frfs/frf_sensitivities.h"
#include "model/linear/modal_analysis.h"

namespace rigfit::ident {

using ModeSolver = std::function<model::ModeSensitivities(
    const model::Scene&, const std::vector<std::string>&, const model::ModesOptions&)>;
using FrfSolver =
    std::function<model::FrfSensitivities(const model::Scene&, const Eigen::VectorXd& frequency_hz,
                                          const std::vector<std::string>&, double decay_rate_1_s)>;

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
  double huber_threshold = 2;         ///< standard deviations beyond which a pair pulls linearly
  PairingOptions pairing = {};        ///< for lists of pairs, and for fits of FRFs
  AssignmentOptions assignment = {};  ///< for fits to modes
  double first_common_factor = 4;     ///< common_factor_range of the first pairing of each start
  /// 1: finds the answer near the scene's own values. More: fits to modes search the whole range of
  /// the parameters (update_alternatives.h); fits to FRFs have this number of starts.
  int starts = 4;
  double start_spread = 3;  ///< largest factor, up or down, of the other starts
  std::uint64_t seed = 1;
  int max_iterations = 60;
  double function_tolerance = 1e-9;  ///< relative change of the cost
  int max_pairings = 8;
  int threads = 1;  ///< work on starts in parallel
  /// All starts but the first search with a third of the segments (if there are 16 or more); only
  /// those that find another minimum than the first continue with all segments.
  bool coarse_starts = true;
  /// True: the error of "auto" segments is subtracted from frequencies, and the rest of it adds to
  /// the uncertainties (update_segments.h). False: the data come from a model with these segments.
  bool segment_uncertainty = true;
  std::vector<UncertainInput> inputs = {};  ///< independent of each other
  /// Initial number of segments of "auto" members; it grows where the data need more.
  int auto_segments = 30;
  bool exact_ends = true;     ///< compute the effect of other end conditions
  bool intervals = true;      ///< by profile where needed, and over all answers; else linear
  ModeSolver solver = {};     ///< empty: model::analyse_mode_sensitivities
  FrfSolver frf_solver = {};  ///< empty: model::synthesize_frf_sensitivities
};

}  // namespace rigfit::ident
