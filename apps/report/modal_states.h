// The states of a modal test (one a tension) with the model's answer to each, before anything is
// shown.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/campaign.h"
#include "apps/report/bending_part.h"
#include "ident/mode_pairing.h"
#include "model/modal_analysis.h"

namespace rigfit::apps {

struct MeasuredRow {
  double measured_hz = 0;           ///< NaN: dash
  std::vector<double> models_hz;    ///< by published model; NaN: dash
  std::optional<std::size_t> mode;  ///< index of the modelled mode paired with it
  bool other_plane = false;         ///< that mode lies in a plane the test was not made to see
};

struct ModalState {
  std::optional<double> tension_N;
  std::optional<double> EI_Nm2;
  model::ModalAnalysis analysis;
  std::vector<MeasuredRow> rows;
  ident::ModePairing pairing;
};

/// Modes of the scene at every state of the test's results, and their pairing.
[[nodiscard]] std::vector<ModalState> modal_states(const Campaign& campaign,
                                                   const CampaignTest& test,
                                                   const StiffnessCurve& EI);

/// The scene as the test has it at one tension.
[[nodiscard]] model::Scene scene_at(const Campaign& campaign, const CampaignTest& test,
                                    const StiffnessCurve& EI, std::optional<double> tension_N);

struct RmsError {
  double value = 0;  ///< rms relative error; NaN without rows
  int rows = 0;
};
[[nodiscard]] RmsError rms_of_model(const std::vector<ModalState>& states);
[[nodiscard]] RmsError rms_of_published(const std::vector<ModalState>& states, std::size_t model);

}  // namespace rigfit::apps
