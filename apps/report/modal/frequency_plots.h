// Natural frequencies of a modal test as figures: against tension, where there are several, else
// one after the other.
#pragma once

#include <vector>

#include "apps/report/drawing/plot.h"
#include "apps/report/modal/modal_states.h"
#include "apps/report/page/report_part.h"

namespace rigfit::apps {

struct TensionPlot {
  Plot plot;
  Json crossings = Json::array();  ///< {tension_N, frequency_hz, modes}
};

/// Lines of the model between the tensions, one a mode, where they cross, and the test's points.
[[nodiscard]] TensionPlot tension_plot(const CampaignTest& test, const ident::SceneUse& use,
                                       const ident::KnownValues& known,
                                       const std::vector<ModalState>& states);

/// Without tensions: frequency by row.
[[nodiscard]] Plot row_plot(const CampaignTest& test, const std::vector<ModalState>& states);

}  // namespace rigfit::apps
