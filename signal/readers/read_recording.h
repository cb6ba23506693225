// Any recording we know, whatever its name ends in: the format is found from the content.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string_view>

#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// Formats that are told apart by their content.
enum class RecordingFormat { csv, lvm, uff, wav, npy, mat };

/// By the first bytes: "    -1" begins UFF, "LabVIEW Measurement" LVM, "RIFF" WAV, "\x93NUMPY" a
/// NumPy array, "MATLAB" with its version mark a .mat file; all else is taken as a table.
[[nodiscard]] RecordingFormat format_of(std::string_view bytes);

/// `options.format` is taken where it is given. `done_with`, when given, is told now and then how
/// many bytes of the file are read (never in a MATLAB file, which a library reads whole). Throws
/// RecordingError with file, line, channel, value and remedy; files of formats that are not read
/// (TDMS, MDF, HDF5, XLSX ...) are named.
[[nodiscard]] Recording read_recording(const std::filesystem::path& path,
                                       const ReadOptions& options = {},
                                       const std::function<void(std::size_t)>& done_with = {});

}  // namespace rigfit::signal
