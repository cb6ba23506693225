// NumPy arrays (.npy, versions 1 to 3): numbers of one or two dimensions, or records with named
// fields. Source: numpy.lib.format, "A simple format for saving numpy arrays".
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string_view>

#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// The longer dimension is time; names of fields are names of channels. `done_with` is told how
/// far the file has been read, where it stands row by row. Throws RecordingError, also for complex
/// numbers, Python objects, more than two dimensions and sizes that the file does not hold.
[[nodiscard]] Recording read_npy(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {},
                                 const std::function<void(std::size_t)>& done_with = {});

}  // namespace rigfit::signal
