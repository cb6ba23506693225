// Spectra and FRFs of tables over frequency, of text or of a workbook.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "signal/readers/csv/frequency_table.h"
#include "signal/readers/files/read_options.h"

namespace rigfit::signal {

/// `bytes` are those of the file at `path`. Empty when it is no table, or none over frequency.
/// Throws RecordingError.
[[nodiscard]] std::optional<FrequencyTable> frequency_table_in(std::string_view bytes,
                                                               const std::filesystem::path& path,
                                                               const ReadOptions& options);

}  // namespace rigfit::signal
