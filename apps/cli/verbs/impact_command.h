// The options of a hammer test on the command line, shared by the verbs that begin with one, and
// its analysis (ident/campaign/modal/hammer_campaign.h).
#pragma once

#include <string>
#include <vector>

#include "apps/cli/plots/plot_option.h"
#include "apps/cli/verb.h"
#include "apps/report/figures/figures.h"
#include "ident/campaign/modal/hammer_campaign.h"

namespace rigfit::apps {

struct ImpactCommand {
  std::vector<std::string> files;
  ident::HammerTestOptions hammer;
  std::vector<std::string> struck;  ///< point struck in each file; empty: one point in all
};

/// Those of the test, without the files.
[[nodiscard]] describe::Options options_of(ImpactCommand& command);

struct ImpactRun {
  /// The points struck and the recordings of each; one without a name unless the hammer roves.
  std::vector<ident::StruckPlace> places;
  ident::HammerTest test;
};

/// Reads the files and analyses the test. Every finding becomes a warning. Throws UsageError for
/// options that make no sense, Refused when there is no hit at all; when all hits were rejected the
/// FRFs are empty and `context.refuse` has said why and what can be had.
[[nodiscard]] ImpactRun run_impact_test(VerbContext& context, const ImpactCommand& command);

/// `hits[]`, as `frf` gives them; each with the point `struck` when the hammer roves.
[[nodiscard]] Json hits_json(const ImpactRun& run);

}  // namespace rigfit::apps
