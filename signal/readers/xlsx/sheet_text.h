// A sheet of a workbook as a table of text: one line a row, so that line 7 is row 7, its fields
// parted by semicolons, numbers with as many digits as give them back exactly.
//
// Formulas give the values saved with them. Cells without a value are empty fields. Refused, with
// the cell: an error (#DIV/0! ...; #N/A is a missing value), a formula saved without its value, a
// date that programs read differently, and a number that is none.
#pragma once

#include <string>
#include <vector>

#include "signal/readers/xlsx/workbook.h"
#include "signal/recording/recording_error.h"

namespace rigfit::signal {

/// 1-based; 0: none.
struct CellPlace {
  long row = 0, column = 0;
};

/// "B7".
[[nodiscard]] std::string cell_name(const CellPlace& place);

struct CellRange {
  CellPlace first, last;
};

struct SheetText {
  std::string file;
  std::string sheet;
  std::string text;
  long first_column = 1;  ///< of the sheet: the first field of each line
  std::vector<CellRange> merged;
  std::vector<CellPlace> number_texts;  ///< cells of text that read as numbers, row by row
  CellPlace percent;                    ///< the first number shown in percent
  long hidden_rows = 0;                 ///< with values, which are read all the same

  /// Of a cell, or of a row where the column is 0.
  [[nodiscard]] RecordingError refusal(const CellPlace& place, std::string value,
                                       std::string problem, std::string remedy) const;
};

/// Throws RecordingError, also for a sheet without numbers.
[[nodiscard]] SheetText sheet_text(ZipParts& parts, const Workbook& workbook,
                                   const WorkbookSheet& sheet, const std::string& file);

}  // namespace rigfit::signal
