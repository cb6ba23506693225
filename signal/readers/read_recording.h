// Reads any supported recording, or FRFs that an analyser exported; the format is detected from the
// content, whatever its name.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

struct FrequencyTable;  // csv/frequency_table.h

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

/// FRFs from a universal or MATLAB file, or from tables over the same lines, of text or of a
/// workbook (one file per response, or one for all). Throws RecordingError.
[[nodiscard]] FrfSet read_frfs(const std::vector<std::filesystem::path>& files,
                               const ReadOptions& options = {});

/// Functions over frequency, FRFs or spectra. `bytes` are those of the file at `path`. Empty when
/// it is no table, or none over frequency. Throws RecordingError.
[[nodiscard]] std::optional<FrequencyTable> frequency_table_in(std::string_view bytes,
                                                               const std::filesystem::path& path,
                                                               const ReadOptions& options = {});

}  // namespace rigfit::signal
