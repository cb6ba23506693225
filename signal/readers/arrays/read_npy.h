// NumPy arrays (.npy, versions 1 to 3): numbers of one or two dimensions, or records with named
// fields. Source: numpy.lib.format, "A simple format for saving numpy arrays".
#pragma once

#include <filesystem>
#include <string_view>

#include "signal/readers/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// The longer dimension is time; names of fields are names of channels. Throws RecordingError, also
/// for complex numbers, Python objects, more than two dimensions and sizes that the file does not
/// hold.
[[nodiscard]] Recording read_npy(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {});

}  // namespace rigfit::signal
