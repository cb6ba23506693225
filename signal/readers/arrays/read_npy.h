// Reads NumPy arrays (.npy, versions 1 to 3): numeric arrays of one or two dimensions, or records
// with named fields. Source: numpy.lib.format, "A simple format for saving numpy arrays".
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string_view>

#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// The longer dimension is time; fields' names become channels' names. `done_with`, if given, is
/// called with the bytes read so far where the array is stored row by row. Throws RecordingError,
/// also for complex numbers, Python objects, more than two dimensions and a file shorter than its
/// header says.
[[nodiscard]] Recording read_npy(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {},
                                 const std::function<void(std::size_t)>& done_with = {});

}  // namespace rigfit::signal
