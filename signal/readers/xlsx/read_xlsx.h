// Reads a sheet of an Excel workbook (.xlsx, ECMA-376) as a table: by the rules of tables of text
// (csv/csv_table.h), on its numbers as they are saved.
//
// Refused besides cells without a sound value: numbers stored as text in the table, and merged
// cells in it or among its titles (a heading alone in its rows above them may be merged).
#pragma once

#include <filesystem>

#include "signal/readers/csv/csv_table.h"
#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// `options.sheet`: name or number ("#2"); empty: the first, and a note names the others. Throws
/// RecordingError with the cell ("Sheet1!B7").
[[nodiscard]] Recording read_xlsx(const std::filesystem::path& path,
                                  const ReadOptions& options = {});

/// The columns of the sheet, whatever they are over.
[[nodiscard]] CsvTable read_xlsx_columns(const std::filesystem::path& path,
                                         const ReadOptions& options = {});

}  // namespace rigfit::signal
