// Reads LabVIEW measurement files (.lvm, text) into a Recording.
//
// Source: National Instruments, "Specification for the LabVIEW Measurement File (.lvm)". One file
// header is followed by segments, each with its own header (channels, units, X0, Delta_X) and
// table, which has no X values, one column of them, or one per channel. Segments of the same
// channels are joined; where gaps lie between them the times are kept.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string_view>

#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// `done_with`, if given, is called with the bytes read so far. Throws RecordingError.
[[nodiscard]] Recording read_lvm(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {},
                                 const std::function<void(std::size_t)>& done_with = {});

}  // namespace rigfit::signal
