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

/// How far the model lies above the test, per cent over frequency, with the test's 95 % bars.
[[nodiscard]] Plot error_by_mode_plot(const std::string& id, const FitFigures& fit);
/// Shares of variance of the identifiable parameters; none when there is no budget.
[[nodiscard]] std::optional<ReportTable> budget_table(const std::string& id,
                                                      const ident::UpdateResult& result);

}  // namespace rigfit::apps
