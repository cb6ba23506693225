// Evaluates a hammer test of one state of a rig: recordings of hits give FRFs, and these give
// modes.
//
// The transducers stay while one or several places are struck, which are the inputs of one set of
// FRFs (signal/impact/roving_hammer.h). Without a band, modes are looked for up to the highest
// frequency that the force of every accepted hit excites.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ident/statistics/finding.h"
#include "signal/impact/roving_hammer.h"
#include "signal/modal/modal_identification.h"
#include "signal/recording/recording.h"

namespace rigfit::ident {

/// The recordings of hits on one place. They have the same channels in the same order.
struct StruckPlace {
  std::string name;  ///< empty: the only place, without a name
  std::vector<signal::Recording> recordings;
};

struct HammerTestOptions {
  std::string force;                   ///< channel: its name, or "#k" for the k-th
  std::vector<std::string> responses;  ///< empty: every other channel that all recordings have
  /// The response at the excitation point, for a single place without a name; empty: unknown. A
  /// named place is at the response of that name.
  std::string driving_point;
  signal::ImpactTestOptions impact;
};

struct HammerTest : signal::RovingHammer {
  std::string force, force_unit;       ///< the channel's name and unit
  std::vector<std::string> responses;  ///< names, or "#k" where a name occurs twice
  bool amplitudes = true;  ///< false: pulses not resolved, so only frequencies are valid
  double usable_hz = 0;    ///< smallest of the accepted hits; 0 without any
  /// Refused: "no_response", "no_hit", "no_hit_accepted", "pulse_not_resolved" (then there are no
  /// FRFs). Warnings: "data_left_out", "point_left_out", and those of the hits and FRFs.
  std::vector<Finding> findings;

  [[nodiscard]] std::size_t hits() const;
  [[nodiscard]] std::size_t accepted_hits() const;
};

/// `places`: at least one, each with at least one recording. Throws signal::RecordingError for
/// recordings that do not fit each other or lack a channel, std::invalid_argument for options that
/// contradict each other (a response that is the force, a driving point that is no response).
[[nodiscard]] HammerTest analyse_hammer_test(std::span<const StruckPlace> places,
                                             const HammerTestOptions& options);

struct IdentifiedModes {
  std::optional<signal::ModalResult> modal;  ///< empty: too few lines; see `findings`
  /// Refused: "no_modes", "rank_deficient", "window_damping" (one mode's damping; its frequency is
  /// valid).
  /// Warnings: "doubtful_mode" and "not_converged" among others.
  std::vector<Finding> findings;
};

/// Modes of FRFs. The band is `band_hz`, or else ends at `usable_hz` (0: the last line);
/// `options.low_hz` and `high_hz` are ignored. The uncertainty of the FRFs' sample rate goes into
/// the frequencies' uncertainty and their covariance (test_recording.h).
[[nodiscard]] IdentifiedModes identify(const signal::FrfSet& frfs,
                                       const std::optional<std::pair<double, double>>& band_hz,
                                       double usable_hz, signal::ModalOptions options = {});

}  // namespace rigfit::ident
