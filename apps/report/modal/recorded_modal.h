// Hammer recordings of a modal test to FRFs and modes, state by state (one a tension): what could
// be used, what could not and why. Places struck in one state become inputs of one set of FRFs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/report/report_part.h"
#include "signal/modal/modal_identification.h"
#include "signal/modal/modal_model.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::apps {

/// One accepted hit as it was recorded, from a little before it.
struct RecordedHit {
  std::string load;
  double rate_hz = 0;
  Eigen::VectorXd force;                          ///< N, offset removed
  Eigen::Index pulse_first = 0, pulse_last = -1;  ///< the blow and what rings after it; noise else
  Eigen::MatrixXd responses;                      ///< samples x responses, values at rest removed
};

struct RecordedModalState {
  std::optional<double> tension_N;
  Origin origin = Origin::measured;
  std::vector<std::string> channels;  ///< responses, in the order of the FRFs
  /// Of positive values, as the recordings say; zero where they do not.
  std::vector<Eigen::Vector3d> directions, force_directions;
  signal::FrfSet frfs;  ///< inputs named by the scene's loads
  signal::ModalModel modes;
  double low_hz = 0, high_hz = 0;  ///< band used
  bool amplitudes = true;          ///< false: only frequencies and damping mean something
  std::vector<RecordedHit> hits;   ///< one a load
};

struct RecordedModal {
  ReportPart part;
  std::vector<RecordedModalState> states;  ///< those that gave modes, by rising tension
};

[[nodiscard]] RecordedModal recorded_modal(const Campaign& campaign, const CampaignTest& test);

/// "200 N", or "as built" without a tension.
[[nodiscard]] std::string state_label(std::optional<double> tension_N);

}  // namespace rigfit::apps
