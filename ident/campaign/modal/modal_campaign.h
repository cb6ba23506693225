// A modal test of a campaign: hits recorded at several states of a rig (one per tension), each of
// which is a hammer test (hammer_campaign.h), or its motion under unknown forces
// (signal/ambient/ambient_modes.h), each recording a set-up of sensors. Unusable recordings are
// refused and the rest is evaluated.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "ident/campaign/modal/hammer_campaign.h"
#include "ident/campaign/single_tests/test_recording.h"
#include "ident/statistics/finding.h"
#include "signal/ambient/ambient_result.h"

namespace rigfit::ident {

struct ModalTestOptions {
  HammerTestOptions hammer;  ///< its band of hits is also the band of the modes
  signal::ModalOptions modal;
  bool ambient = false;  ///< no force; of the options of hits, responses and band count
  std::vector<std::string> references;  ///< ambient: channels that stay in all set-ups
};

struct ModalTestState {
  std::optional<double> tension_N;
  Origin origin = Origin::measured;
  std::vector<StruckPlace> places;
  HammerTest hammer;  ///< empty for ambient motion; inputs named by the places; "hammer" without
  std::optional<signal::ModalResult> modal;      ///< empty: no FRFs, or too few lines
  std::optional<signal::AmbientResult> ambient;  ///< its modes are `modal`'s
  std::vector<std::string> channels;             ///< responses, in the order of the FRFs
  /// Axes of positive values from the recordings, by response and by input; zero if not stated.
  std::vector<Eigen::Vector3d> directions, force_directions;
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
