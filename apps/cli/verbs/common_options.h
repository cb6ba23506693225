// Options of every verb, and of those that read recordings.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "apps/cli/plots/plot_option.h"
#include "apps/cli/verb_context.h"
#include "apps/describe/option.h"
#include "signal/readers/files/read_options.h"

namespace rigfit::apps {

struct CommonOptions {
  std::string json;
  bool quiet = false, verbose = false;
  int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::uint64_t seed = 1;
};

[[nodiscard]] describe::Options options_of(CommonOptions& common);

/// What a person says of every recording of a run, as in the TOML file beside it.
struct ReadingOptions {
  signal::ReadOptions reading;
  std::string decimal, separator, time_unit;  ///< into `reading`, by read_options
};
[[nodiscard]] describe::Options options_of(ReadingOptions& given);

[[nodiscard]] signal::ReadOptions read_options(const ReadingOptions& given);

/// What stands beside a verb's own options.
struct SharedOptions {
  CommonOptions common;
  ReadingOptions reading;
  PlotCommand plots;

  /// For a verb that reads recordings, that draws.
  [[nodiscard]] describe::Options options(bool reads, bool draws);
  /// But for the figures.
  void apply(VerbContext& context) const;
};

}  // namespace rigfit::apps
