// Any recording we know, whatever its name ends in: the format is found from the content.
#pragma once

#include <filesystem>
#include <string_view>

#include "signal/readers/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// Formats that are told apart by their content.
enum class RecordingFormat { csv, lvm, uff };

/// By the first lines: "    -1" begins UFF, "LabVIEW Measurement" LVM; all else is taken as a
/// table.
[[nodiscard]] RecordingFormat format_of(std::string_view bytes);

/// Throws RecordingError with file, line, channel, value and remedy.
[[nodiscard]] Recording read_recording(const std::filesystem::path& path,
                                       const ReadOptions& options = {});

}  // namespace rigfit::signal
