// A table of columns, of text or of arrays, as a recording with its times and rate.
#pragma once

#include <filesystem>
#include <string>

#include "signal/readers/csv/csv_columns.h"
#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// Throws RecordingError, also for a table over frequency (frequency/frequency_table.h): a spectrum
/// is no recording over time.
[[nodiscard]] Recording recording_of_table(CsvTable table, const std::filesystem::path& path,
                                           const std::string& format, const ReadOptions& options);

}  // namespace rigfit::signal
