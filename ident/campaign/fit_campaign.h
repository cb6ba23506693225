// A fit of a campaign: fits a scene's uncertain parameters to the measurements of all states,
// predicts states that were held out, and lists findings to be read before the numbers are used.
// The verb and the report both call it.
#pragma once

#include <string>
#include <vector>

#include "ident/statistics/finding.h"
#include "ident/update/model_update.h"

namespace rigfit::ident {

struct FitTask {
  std::vector<UpdateState> states;
  std::vector<FreeParameter> free;
  UpdateOptions options;  ///< states are held out where there are two or more
};

struct FitOutcome {
  UpdateResult result;
  double rms_held_out = 0;        ///< rms over all pairs that were held out; NaN without
  std::vector<Finding> findings;  ///< most severe first
};

/// Throws like update_model.
[[nodiscard]] FitOutcome fit_campaign(const FitTask& task);

/// Findings to be read before the numbers of a fit are used, most severe first.
[[nodiscard]] std::vector<Finding> fit_findings(const UpdateResult& result);

/// "chi-square 12.3 on 8 degrees of freedom, probability 0.14 ...".
[[nodiscard]] std::string fit_text(const UpdateFit& fit);

/// Describes each alternative but the first, and why it has less weight.
[[nodiscard]] std::vector<std::string> alternative_texts(const UpdateResult& result);

}  // namespace rigfit::ident
