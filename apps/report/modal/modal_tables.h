// The tables of a modal test: its equilibria, measured and modelled frequencies beside each other,
// errors against the test.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "apps/report/modal/modal_states.h"
#include "apps/report/page/report_part.h"

namespace rigfit::apps {

[[nodiscard]] std::string label_of(const ModalState& state);

/// Published models of the test's table: label, column; empty without a table.
[[nodiscard]] const std::vector<std::pair<std::string, std::size_t>>& published_models(
    const CampaignTest& test);

/// Number of a mode among those of its plane: "in 2".
[[nodiscard]] std::string mode_name(const model::ModalAnalysis& analysis, std::size_t index);

[[nodiscard]] ReportTable equilibrium_table(const CampaignTest& test,
                                            const std::vector<ModalState>& states);
[[nodiscard]] ReportTable pairs_table(const CampaignTest& test,
                                      const std::vector<ModalState>& states);
/// Root-mean-square errors of this model and of the published ones, state by state.
[[nodiscard]] ReportTable error_table(const CampaignTest& test,
                                      const std::vector<ModalState>& states);

}  // namespace rigfit::apps
