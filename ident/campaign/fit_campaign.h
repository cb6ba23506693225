// A fit of a campaign: a scene's uncertain parameters fitted to what was measured in all states,
// states held out and predicted, and what to look at before the numbers are used. One way for the
// verb and for the report.
#pragma once

#include <string>
#include <vector>

#include "ident/campaign/single_tests/finding.h"
#include "ident/update/model_update.h"
#include "ident/update/update_checks.h"

namespace rigfit::ident {

struct FitTask {
  std::vector<UpdateState> states;
  std::vector<FreeParameter> free;
  UpdateOptions options;
  bool hold_out = false;  ///< each state in turn, where there are two or more
};

struct FitOutcome {
  UpdateResult result;
  std::vector<HeldOut> held;      ///< empty: nothing was held out
  double rms_held_out = 0;        ///< rms over all pairs that were held out; NaN without
  std::vector<Finding> findings;  ///< the gravest first
};

/// Throws as update_model does. Fits to modes with a state held out begin at the answer to all, so
/// that they do not end in another assignment; what only the held-out state has stays as it was
/// known before.
[[nodiscard]] FitOutcome fit_campaign(const FitTask& task);

/// What to look at before the numbers of a fit are used, the gravest first.
[[nodiscard]] std::vector<Finding> fit_findings(const UpdateResult& result);

/// "chi-square 12.3 on 8 degrees of freedom, probability 0.14 ...".
[[nodiscard]] std::string fit_text(const UpdateFit& fit);

/// What the fit takes as exact; then, of each parameter, what 1 % of these inputs changes it by,
/// the largest first, where that is more than its standard uncertainty; and what other end
/// conditions change. Empty where nothing is.
[[nodiscard]] std::vector<std::string> exact_input_texts(const UpdateResult& result);

/// Says of each alternative but the first what it is and why it weighs less.
[[nodiscard]] std::vector<std::string> alternative_texts(const UpdateResult& result);

}  // namespace rigfit::ident
