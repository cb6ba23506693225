// An impact test from recordings to FRFs with error bars: hits found and judged, outliers left out,
// the accepted ones averaged, the driving point checked.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "signal/impact/impact_hits.h"
#include "signal/recording/recording.h"
#include "signal/spectra/frf.h"
#include "signal/spectra/frf_checks.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

struct ImpactTestOptions {
  HitOptions hits;
  FrfEstimator estimator = FrfEstimator::h1;
  /// Force kept after the beginning of the pulse, s, then faded out over half as long. 0: all of
  /// it; negative: three pulse durations, each hit its own. Not given: by the noise on the force
  /// (`force_noise_limit`), three pulse durations or all of it.
  std::optional<double> force_window_s;
  /// A window is chosen where noise on the force has this part of the force's power at half of the
  /// band's lines: random errors of H of 2 % a hit. A hum's few lines are better left as they are:
  /// a short window would spread them over the band.
  double force_noise_limit = 1e-3;
  /// Rate of a shared exponential window, 1/s; or, if positive, the level it falls to by the end of
  /// the block.
  double exponential_decay_rate_1_s = 0;
  double exponential_end_level = 0;
  Eigen::Index error_smoothing_lines = 10;  ///< see FrfOptions
  bool reject_outliers = true;              ///< from three accepted hits on
  /// A hit is an outlier when leaving it out lowers the incoherent power by more than this chance
  /// allows for the worst of n hits that all differ in one way, as by a frequency that changes
  /// (Grubbs, Ann. Math. Stat. 21 (1950) 27: the power left over all of it is Beta((n - 2) / 2, 1 /
  /// 2)) and below half of it per degree of freedom. Where the others leave more than ten times
  /// what noise on the responses does, all hits differ: a fifth of the chance then, since a hit
  /// left out by chance makes their scatter too small ...
  double outlier_chance = 0.05;
  double outlier_least = 1e-3;  ///< ... and that power is at least this part of the response power
  std::optional<Eigen::Index> driving_response;  ///< index into the responses
  int threads = 1;
};

struct ImpactTest {
  HitSearch search;
  std::vector<Eigen::Index> responses;  ///< channel indices, in the order of the FRFs
  FrfSet frfs;                          ///< no lines when no hit was accepted
  bool amplitudes = true;  ///< false: pulses were not resolved; only frequencies mean something
  double usable_hz = 0;    ///< least of the accepted hits': the force spectrum beyond is too low
  /// Part of the response power that the force does not explain, per degree of freedom; 0 for fewer
  /// than three hits.
  double incoherence = 0;
  /// Noise on the force where no hit is, without any window: median over the band's lines of its
  /// share of the force's power, by which H1 would be too small. Empty: too few samples to tell.
  std::optional<double> force_noise;
  /// The same of what the force window leaves, at the worst line. It is taken off H1.
  double force_noise_left = 0;
  double force_window_s = 0;           ///< length kept, mean over the hits; 0: no window
  bool force_window_by_noise = false;  ///< chosen, not asked for
  std::optional<DrivingPointCheck> driving_point;
  std::vector<Note> notes;
};

/// `force` and `responses` are names as for Recording::channel_index; every recording has them.
/// Throws RecordingError when they are not there, and for what find_hits() throws.
[[nodiscard]] ImpactTest analyse_impact_test(std::span<const Recording> recordings,
                                             const std::string& force,
                                             std::span<const std::string> responses,
                                             const ImpactTestOptions& options = {});

}  // namespace rigfit::signal
