// Options of every verb, and of those that read recordings.
#pragma once

#include <string>

#include "apps/cli/plots/plot_option.h"
#include "apps/cli/verb_context.h"
#include "apps/describe/option.h"
#include "signal/readers/files/read_options.h"

namespace rigfit::apps {

/// What a person says of every recording of a run, as in the TOML file beside it.
[[nodiscard]] describe::Options options_of(signal::ReadOptions& reading);

/// What stands beside a verb's own options; most of it goes straight into the context of the run.
struct SharedOptions {
  std::string json;
  PlotCommand plots;

  /// For a verb that reads recordings, that draws.
  [[nodiscard]] describe::Options options(VerbContext& context, bool reads, bool draws);
};

}  // namespace rigfit::apps
