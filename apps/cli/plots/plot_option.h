// --plot FILE, common to the verbs that draw: the figures of a run, built by the
// functions that a report's page uses, as one HTML page, one SVG or one PNG, which the machine's
// Chromium makes.
#pragma once

#include "apps/cli/verb_context.h"
#include "apps/report/page/report_part.h"

namespace rigfit::apps {

/// The figures of a run. A verb adds to it when VerbContext::plots is set.
struct PlotSheet {
  std::vector<Block> blocks;

  /// A block, or a list of them.
  template <class Any>
  void add(Any more) {
    apps::add(blocks, std::move(more));
  }
};

/// Chromium or a browser that takes its options, looked for on the PATH; empty: none.
[[nodiscard]] std::string find_chromium();

/// Runs headless Chromium on a local file with further options, such as --screenshot=F. False when
/// it fails.
bool run_chromium(const std::string& chromium, const std::vector<std::string>& options,
                  const std::filesystem::path& page);

/// The command line as one types it in a shell.
[[nodiscard]] std::string repeat_command(const VerbContext& context);

/// Before the run: throws UsageError when the file cannot be written or its kind cannot be made
/// here; sets `context.plots` when figures are asked for.
void prepare_plots(VerbContext& context, const std::string& file);

/// After the run: writes the file. Without any figure it writes nothing and warns.
void write_plots(VerbContext& context, const std::string& file, const std::string& verb);

}  // namespace rigfit::apps
