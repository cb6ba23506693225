// A fit of the campaign as it came out, and its tables.
#pragma once

#include <string>
#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/report/page/report_part.h"
#include "ident/campaign/campaign.h"

namespace rigfit::apps {

// A fit of the campaign as it came out, before anything of it is shown.

struct FitOutcome {
  const Campaign& campaign;
  const CampaignFit& fit;
  const std::vector<std::size_t>& modal_tests;  ///< the campaign's tests, by CampaignResult::modal
  const ident::CampaignFitOutcome& answer;
  const std::vector<ident::FittedState>& states = answer.states;
  const std::vector<ident::UpdateState>& updates = answer.task.states;  ///< what was fitted to
  const ident::UpdateResult& result = answer.outcome.result;
  const std::vector<ident::HeldOut>& held = answer.outcome.held;  ///< empty: nothing was held out

  [[nodiscard]] const std::string& name_of_state(int state) const {
    return updates[static_cast<std::size_t>(state)].name;
  }
  [[nodiscard]] Origin origin_of(std::size_t state) const {
    const auto* recorded = states[state].modal->recorded;
    return recorded ? recorded->origin : Origin::published;
  }
  [[nodiscard]] const CampaignTest& test_of(std::size_t state) const {
    return campaign.tests[modal_tests[states[state].test]];
  }
};

// The tables of a fit and the same numbers for programs: parameters, errors, pairs, likeness of
// shapes.

/// "0.82 %"; a dash where there is none.
[[nodiscard]] std::string percent_words(double ratio);

void add_parameters(ReportPart& part, const FitOutcome& of);

/// Errors before, fitted and held out, by state. Returns the rms of all that was held out; NaN
/// without.
double add_errors(ReportPart& part, const FitOutcome& of);

void add_pairs(ReportPart& part, const FitOutcome& of);

/// MAC of every measured mode with every modelled one, where two sensors or more make shapes; the
/// modelled shapes as UFF.
void add_shapes(ReportPart& part, const FitOutcome& of);

}  // namespace rigfit::apps
