// Reads any supported recording, or FRFs that an analyser exported; the format is detected from the
// content, whatever its name.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "signal/readers/recording_description.h"
#include "signal/recording/recording.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

struct CsvTable;  // csv/csv_table.h

/// The name of the format (format_names) by the first bytes: "    -1" begins UFF, "LabVIEW
/// Measurement" LVM, "RIFF" WAV, "\x93NUMPY" a NumPy array, "MATLAB" with its version mark a .mat
/// file, a zip archive of an Excel workbook's parts .xlsx. Everything else is read as a table of
/// text.
[[nodiscard]] std::string format_of(std::string_view bytes);

/// `options.format`, if given, overrides the detection. Throws RecordingError with file, line,
/// channel, value and remedy. Formats that are recognised but not read (TDMS, MDF, HDF5, XLS ...)
/// are refused by name, with advice on how to convert them.
[[nodiscard]] Recording read_recording(const std::filesystem::path& path,
                                       const ReadOptions& options = {});

/// FRFs from a universal or MATLAB file, or from tables over the same lines, of text or of a
/// workbook (one file per response, or one for all). Throws RecordingError.
[[nodiscard]] FrfSet read_frfs(const std::vector<std::filesystem::path>& files,
                               const ReadOptions& options = {});

/// Functions over frequency, FRFs or spectra, as csv/frequency_table.h has them. `bytes` are those
/// of the file at `path`. Empty when it is no table, or none over frequency. Throws RecordingError.
[[nodiscard]] std::optional<CsvTable> frequency_table_in(std::string_view bytes,
                                                         const std::filesystem::path& path,
                                                         const ReadOptions& options = {});

}  // namespace rigfit::signal
