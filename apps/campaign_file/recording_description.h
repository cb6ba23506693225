// A recording read with its description (signal/readers/recording_description.h), as an input of
// a run of the program.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/cli/verb_context.h"
#include "signal/readers/recording_description.h"
#include "signal/recording/recording.h"

namespace rigfit::apps {

using signal::RecordingDescription;

/// Reads a recording with the TOML file beside it, if there is one; both become inputs of this run
/// and every note of the reader becomes a warning. `given` adds to (and wins over) the file beside
/// it: what a campaign entry or the command line says.
[[nodiscard]] signal::Recording load_recording(const std::filesystem::path& path,
                                               VerbContext& context,
                                               const RecordingDescription& given = {});

/// The same; its notes are not told yet.
[[nodiscard]] signal::Recording load_untold(const std::filesystem::path& path, VerbContext& context,
                                            const RecordingDescription& given = {});

/// Spectra and FRFs of a UFF file or a table, which are not over time; empty: the file has none.
[[nodiscard]] std::optional<signal::Recording> over_frequency(const std::string& path,
                                                              const signal::ReadOptions& reading);

/// The channel `name`; without a name that of a recording with one channel only. Throws UsageError
/// when the choice is open or the sample rate is not known.
[[nodiscard]] const signal::Channel& chosen_channel(const signal::Recording& recording,
                                                    const std::string& name);

}  // namespace rigfit::apps
