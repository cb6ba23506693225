// LabVIEW measurement files (.lvm, text) to a Recording.
//
// Source: National Instruments, "Specification for the LabVIEW Measurement File (.lvm)". One file
// header, then segments, each with its own header (channels, units, X0, Delta_X) and table; X
// values none, one column, or one per channel. Segments of the same channels are joined; where they
// do not follow each other without a gap the times are kept.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string_view>

#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// `done_with` is told how far the file has been read. Throws RecordingError.
[[nodiscard]] Recording read_lvm(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {},
                                 const std::function<void(std::size_t)>& done_with = {});

}  // namespace rigfit::signal
