// Load-deflection tables and records, by the quantities of their columns.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/cli/verb_context.h"
#include "signal/recording/recording.h"

namespace rigfit::apps {

/// The channels of a load-deflection table or record.
struct LoadDeflection {
  std::string tension, load, deflection;  ///< tension: empty where there is none
  bool operator==(const LoadDeflection&) const = default;
};

/// By names ("tension", "load", "deflection" ...), else by their quantities: one displacement and a
/// force (or mass) that rises and falls with it; of two forces the one that does so least, or that
/// hardly changes, is the tension. Empty: the recording is something else.
[[nodiscard]] std::optional<LoadDeflection> load_deflection(const signal::Recording& recording);

/// A recording with the descriptions beside it, whose notes are not told yet.
[[nodiscard]] signal::Recording load_untold(const std::filesystem::path& path, VerbContext& context,
                                            const signal::ReadOptions& options = {});

}  // namespace rigfit::apps
