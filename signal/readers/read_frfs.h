// Reads FRFs that an analyser exported: universal files (dataset 58), MATLAB files, or tables over
// frequency, of text or of a workbook.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "signal/readers/files/read_options.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

struct FrequencyTable;  // csv/frequency_table.h

/// FRFs from a universal or MATLAB file, or from text tables over the same lines (one file per
/// response, or one for all). Throws RecordingError.
[[nodiscard]] FrfSet read_frfs(const std::vector<std::filesystem::path>& files,
                               const ReadOptions& options = {});

/// Functions over frequency, FRFs or spectra. `bytes` are those of the file at `path`. Empty when
/// it is no table, or none over frequency. Throws RecordingError.
[[nodiscard]] std::optional<FrequencyTable> frequency_table_in(std::string_view bytes,
                                                               const std::filesystem::path& path,
                                                               const ReadOptions& options = {});

}  // namespace rigfit::signal
