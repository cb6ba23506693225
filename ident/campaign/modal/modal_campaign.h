// A modal test of a campaign: hits recorded at several states of a rig (one per tension), or its
// motion under unknown forces (signal/ambient/ambient_modes.h), each recording a set-up of sensors.
// Unusable recordings are refused and the rest is evaluated.
//
// Each state is a hammer test: recordings of hits give FRFs, and these give modes. The transducers
// stay while one or several places are struck, which are the inputs of one set of FRFs
// (signal/impact/roving_hammer.h). Without a band, modes are looked for up to the highest frequency
// that the force of every accepted hit excites.
#pragma once

#include "ident/campaign/single_tests/test_recording.h"
#include "signal/ambient/ambient_modes.h"
#include "signal/impact/roving_hammer.h"
#include "signal/modal/modal_identification.h"

namespace rigfit::ident {

struct HammerTestOptions {
  std::string force;                   ///< channel: its name, or "#k" for the k-th
  std::vector<std::string> responses;  ///< empty: every other channel that all recordings have
  /// The response at the excitation point, for a single place without a name; empty: unknown. A
  /// named place is at the response of that name.
  std::string driving_point;
  signal::ImpactTestOptions impact;
};

struct HammerTest : signal::RovingHammer {
  std::string force;                   ///< the channel's name
  std::vector<std::string> responses;  ///< names, or "#k" where a name occurs twice
  bool amplitudes = true;  ///< false: pulses not resolved, so only frequencies are valid
  double usable_hz = 0;    ///< smallest of the accepted hits; 0 without any
  /// Refused: "no_response", "no_hit", "no_hit_accepted", "pulse_not_resolved" (then there are no
  /// FRFs). Warnings: "data_left_out", "point_left_out", and those of the hits and FRFs.
  std::vector<Finding> findings;

  [[nodiscard]] std::size_t hits() const;
  [[nodiscard]] std::size_t accepted_hits() const;
};

/// `places`: at least one, each with at least one recording; the response at an only place is
/// filled in. Throws signal::RecordingError for recordings that do not fit each other or lack a
/// channel, std::invalid_argument for options that contradict each other (a response that is the
/// force, a driving point that is no response).
[[nodiscard]] HammerTest analyse_hammer_test(std::vector<signal::StruckPoint>& places,
                                             const HammerTestOptions& options);

/// Modes of FRFs; empty: too few lines. The band is `band_hz`, or else ends at `usable_hz` (0: the
/// last line); `options.low_hz` and `high_hz` are ignored. The uncertainty of the FRFs' sample rate
/// goes into the frequencies' uncertainty and their covariance (test_recording.h). Findings,
/// refused: "no_modes", "rank_deficient", "window_damping" (one mode's damping; its frequency is
/// valid); warnings: "doubtful_mode" and "not_converged" among others.
[[nodiscard]] std::optional<signal::ModalResult> identify(
    const signal::FrfSet& frfs, const std::optional<std::pair<double, double>>& band_hz,
    double usable_hz, signal::ModalOptions options, std::vector<Finding>& findings);

struct ModalTestOptions {
  HammerTestOptions hammer;  ///< its band of hits is also the band of the modes
  signal::ModalOptions modal;
  bool ambient = false;  ///< no force; of the options of hits, responses and band count
  std::vector<std::string> references;  ///< ambient: channels that stay in all set-ups
};

struct ModalTestState {
  std::optional<double> tension_N;
  Origin origin = Origin::measured;
  std::vector<signal::StruckPoint> places;
  HammerTest hammer;  ///< empty for ambient motion; inputs named by the places; "hammer" without
  std::optional<signal::ModalResult> modal;      ///< empty: no FRFs, or too few lines
  std::optional<signal::AmbientResult> ambient;  ///< its modes are `modal`'s
  std::vector<std::string> channels;             ///< responses, in the order of the FRFs
  /// Axes of positive values from the recordings, by response and by input; zero if not stated.
  std::vector<Vector3d> directions, force_directions;
  std::vector<Finding> findings;  ///< findings on hits, FRFs and modes

  [[nodiscard]] bool has_modes() const { return modal && !modal->model.modes.empty(); }
};

struct ModalTest {
  std::vector<ModalTestState> states;  ///< by rising tension
  std::vector<Finding> findings;       ///< recordings that cannot take part (code "recording")
};

/// Recordings must be evenly sampled, at the rate that most have, with the requested channels and
/// the force in N (or without a unit); others are refused without an exception.
[[nodiscard]] ModalTest run_modal_test(std::vector<TestRecording> recordings,
                                       const ModalTestOptions& options);

}  // namespace rigfit::ident
