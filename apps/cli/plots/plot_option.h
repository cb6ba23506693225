// --plot FILE, common to the verbs that draw: the figures of a run, built by the
// functions that a report's page uses, as one HTML page, one SVG or one PNG.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "apps/cli/verb_context.h"
#include "apps/describe/option.h"
#include "apps/report/page/report_part.h"

namespace rigfit::apps {

/// As typed.
struct PlotCommand {
  std::string file;  ///< ends with .html, .svg or .png; empty: no figures
};

/// The figures of a run. A verb adds to it when VerbContext::plots is set.
struct PlotSheet {
  std::vector<Block> blocks;
  std::size_t sources = 0;  ///< recordings met so far, where a verb draws only the first

  /// A block, or a list of them.
  template <class Any>
  void add(Any more) {
    apps::add(blocks, std::move(more));
  }
};

[[nodiscard]] describe::Options options_of(PlotCommand& command);

/// The command line as one types it in a shell.
[[nodiscard]] std::string repeat_command(const VerbContext& context);

/// Before the run: throws UsageError when the file cannot be written or its kind cannot be made
/// here; sets `context.plots` when figures are asked for.
void prepare_plots(VerbContext& context, const PlotCommand& command);

/// After the run: writes the file. Without any figure it writes nothing and warns.
void write_plots(VerbContext& context, const PlotCommand& command, const std::string& verb);

}  // namespace rigfit::apps
