// A modal test of a campaign as a part of the report.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/report/drawing/plot.h"
#include "apps/report/page/report_part.h"
#include "ident/campaign/modal/modal_model.h"
#include "ident/campaign/modal/model_answers.h"

namespace rigfit::apps {

using ident::Instrumented;
using ident::MeasuredRow;
using ident::ModalState;
using ident::RmsError;

// The tables of a modal test: its equilibria, measured and modelled frequencies beside each other,
// errors against the test.

[[nodiscard]] std::string label_of(const ModalState& state);

/// Published models of the test's table: label, column; empty without a table.
[[nodiscard]] const PublishedModels& published_models(const CampaignTest& test);

/// Number of a mode among those of its plane: "in 2".
[[nodiscard]] std::string mode_name(const model::ModalAnalysis& analysis, std::size_t index);

[[nodiscard]] ReportTable equilibrium_table(const CampaignTest& test,
                                            const std::vector<ModalState>& states);
[[nodiscard]] ReportTable pairs_table(const CampaignTest& test,
                                      const std::vector<ModalState>& states);
/// Root-mean-square errors of this model and of the published ones, state by state.
[[nodiscard]] ReportTable error_table(const CampaignTest& test,
                                      const std::vector<ModalState>& states);

// Natural frequencies of a modal test as figures: against tension, where there are several, else
// one after the other.

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

// Figures of the model against a hammer test: FRFs, and the response to a hit as it was recorded.

using ident::ModelVersion;

/// Magnitudes of the test with their band, and of every version; empty series when nothing could be
/// computed.
[[nodiscard]] Plot frf_overlay_plot(const std::string& id, const ident::ModalTestState& recorded,
                                    const Instrumented& rig,
                                    const std::vector<ModelVersion>& versions);

/// What a response computation did and left out, in words.
[[nodiscard]] ModelCost response_cost(const std::string& what, const model::ResponseResult& result);

// Modes of a scene against a test, tension by tension: static equilibrium, natural modes, measured
// frequencies paired with modelled ones, published models beside them.

/// `states`: of the model, by rising tension; `known`: what its scene took from other tests.
[[nodiscard]] ReportPart modal_part(const Campaign& campaign, const CampaignTest& test,
                                    const ident::KnownValues& known,
                                    const std::vector<ModalState>& states);

}  // namespace rigfit::apps
