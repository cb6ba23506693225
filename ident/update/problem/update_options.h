// How an update is done. Every default serves; a user of the library sets few of them.
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
  /// Relative standard uncertainty of frequencies that come without one; it then only weighs, the
  /// scatter about the fit gives the variance.
  double assumed_relative_std = 0.01;
  double assumed_damping_relative_std = 0.2;
  /// Relative standard uncertainty of FRFs that come without one; it then only weighs.
  double assumed_frf_relative_std = 0.05;
  /// What the model cannot reach, relative in FRFs, added to every line's uncertainty.
  double frf_model_relative_std = 0;
  /// Lines whose uncertainty is a larger part of the FRF say nothing in their logarithm.
  double frf_max_relative_std = 0.5;
  /// Standard uncertainty of a component of a unit shape; 0: shapes only pair, they are not fitted.
  double shape_std = 0;
  /// What the model cannot reach, relative in frequency, added to every measured uncertainty.
  double model_relative_std = 0;
  double huber_threshold = 2;         ///< standard deviations beyond which a pair pulls linearly
  PairingOptions pairing = {};        ///< for lists of pairs, and for fits of FRFs
  AssignmentOptions assignment = {};  ///< for fits to modes
  double first_common_factor = 4;     ///< common_factor_range of the first pairing of each start
  /// 1: the answer near the scene's own values. More: fits to modes look over the whole range of
  /// the parameters (update_alternatives.h); fits of FRFs begin so many times.
  int starts = 4;
  double start_spread = 3;  ///< factor by which the others are off, up or down, at most
  std::uint64_t seed = 1;
  int max_iterations = 60;
  double function_tolerance = 1e-9;  ///< relative, of the cost
  int max_pairings = 8;
  int threads = 1;  ///< over the starts
  /// Starts but the first look for their minimum with a third of the segments (from 16 on); only
  /// those that find another one than the first are followed with all.
  bool coarse_starts = true;
  /// The segments' error is taken off frequencies where the scene leaves them to the program, and
  /// what is left of it part of the uncertainties (update_segments.h). False: the data have this
  /// model's segments.
  bool segment_uncertainty = true;
  std::vector<UncertainInput> inputs = {};  ///< independent of each other
  /// Segments of members that leave them to the program, at first: more where the data need them.
  int auto_segments = 30;
  bool exact_ends = true;     ///< what other end conditions would change is worked out
  ModeSolver solver = {};     ///< empty: model::analyse_mode_sensitivities
  FrfSolver frf_solver = {};  ///< empty: model::synthesize_frf_sensitivities
};

}  // namespace rigfit::ident
