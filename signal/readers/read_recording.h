// Reads any supported recording; its format is detected from the content, whatever its name.
#pragma once

#include <filesystem>
#include <string_view>

#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// Formats that are told apart by their content.
enum class RecordingFormat { csv, lvm, uff, wav, npy, mat, xlsx };

/// Detects the format by the first bytes: "    -1" begins UFF, "LabVIEW Measurement" LVM, "RIFF"
/// WAV,
/// "\x93NUMPY" a NumPy array, "MATLAB" with its version mark a .mat file, a zip archive
/// of an Excel workbook's parts .xlsx. Everything else is read as a table of text.
[[nodiscard]] RecordingFormat format_of(std::string_view bytes);

/// `options.format`, if given, overrides the detection. Throws RecordingError with file, line,
/// channel, value and remedy. Formats that are recognised but not read (TDMS, MDF, HDF5, XLS ...)
/// are refused by name, with advice on how to convert them.
[[nodiscard]] Recording read_recording(const std::filesystem::path& path,
                                       const ReadOptions& options = {});

}  // namespace rigfit::signal
