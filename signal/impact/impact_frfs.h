// An impact test from recordings to FRFs with error bars: hits found and judged, outliers left out,
// the accepted ones averaged.
//
// One of three accepted hits or more is an outlier when leaving it out halves the incoherent power
// per degree of freedom, and lowers that power by more than happens with a chance of 5 % for the
// worst of n hits that differ in one way, such as a changing frequency (Grubbs, Ann. Math. Stat. 21
// (1950) 27: the ratio of the powers is Beta((n - 2) / 2, 1 / 2)). Where the other hits leave more
// than ten times the noise of the responses, all hits differ, and the chance is 1 %, since a hit
// left out by chance makes their scatter too small.
#pragma once

#include "signal/impact/impact_hits.h"
#include "signal/spectra/frf.h"

namespace rigfit::signal {

struct ImpactTestOptions {
  HitOptions hits;
  FrfEstimator estimator = FrfEstimator::h1;
  /// Length of force kept after the beginning of the pulse, s; it is then faded out over half that
  /// length. Not given: three durations of each hit's pulse, to which the delay of a second contact
  /// too small for a double hit is added. 0: the whole block, whose noise weighs single lines of a
  /// resonance by chance; for phases at frequencies near the corner of an AC-coupled force.
  std::optional<double> force_window_s;
  /// Rate of an exponential window on force and responses, 1/s. `exponential_end_level`, if
  /// positive, gives it instead by the level at the end of the block.
  double exponential_decay_rate_1_s = 0;
  double exponential_end_level = 0;
};

struct ImpactTest {
  HitSearch search;
  std::vector<Index> responses;  ///< channel indices, in the order of the FRFs
  FrfSet frfs;                   ///< no lines when no hit was accepted
  bool amplitudes = true;        ///< false: pulses not resolved, so only frequencies are valid
  double usable_hz = 0;          ///< smallest of the accepted hits: beyond, the force is too weak
  /// Share of noise left by the force window, at the worst line; H1 is corrected for it.
  double force_noise_left = 0;
  double force_window_s = 0;  ///< length kept, mean over the hits; 0: no window
  std::vector<Note> notes;
};

/// `force` and `responses` are names as for Recording::channel_index. Throws RecordingError when a
/// recording lacks one of them, and like find_hits().
[[nodiscard]] ImpactTest analyse_impact_test(std::span<const Recording> recordings,
                                             const std::string& force,
                                             std::span<const std::string> responses,
                                             const ImpactTestOptions& options = {});

}  // namespace rigfit::signal
