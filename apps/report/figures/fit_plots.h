// A fit of a model to measured modes as figures: model against test, errors mode by mode, where
// each parameter's uncertainty comes from.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/report/page/report_part.h"
#include "ident/update/problem/update_data.h"
#include "ident/update/problem/update_result.h"
#include "ident/update/update_checks.h"

namespace rigfit::apps {

/// What a fit was made of and gave.
struct FitFigures {
  const std::vector<ident::UpdateState>& states;
  const ident::UpdateResult& result;
  const std::vector<ident::HeldOut>& held;  ///< empty: nothing was held out
};

/// Model over test, before and fitted, all modes of all states on equal axes, with the 95 % of test
/// and model together.
[[nodiscard]] Plot parity_plot(const std::string& id, const FitFigures& fit);
/// How far the model lies above the test, per cent over frequency, with the test's 95 % bars.
[[nodiscard]] Plot error_by_mode_plot(const std::string& id, const FitFigures& fit);
/// Shares of variance of the identifiable parameters; none when there is no budget.
[[nodiscard]] std::optional<Picture> budget_picture(const std::string& id,
                                                    const ident::UpdateResult& result);
/// MAC of the pairs that have one, by state; none without shapes.
[[nodiscard]] std::optional<Plot> pair_mac_plot(const std::string& id, const FitFigures& fit);

}  // namespace rigfit::apps
