// What a workbook (.xlsx, ECMA-376 part 1) says besides its sheets' cells: the sheets, the texts
// that cells share, which cell formats show dates, and the day that dates count from.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "signal/readers/xlsx/zip_parts.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// What a cell's number means by its format.
enum class CellFormat {
  number,
  percent,
  date,       ///< a day
  date_time,  ///< a day and the time
  time,       ///< time of day, or hours passed
};

struct WorkbookSheet {
  std::string name;
  std::string part;  ///< in the archive; empty: no sheet of cells (a chart)
  bool hidden = false;
};

struct Workbook {
  std::vector<WorkbookSheet> sheets;
  std::vector<CellFormat> formats;  ///< by the number that cells give as their style
  bool from_1904 = false;           ///< dates count from 1904-01-01, not from 1900

  [[nodiscard]] std::size_t strings() const { return string_ends.size(); }
  [[nodiscard]] std::string_view string(std::size_t index) const;
  std::string string_text;  ///< the shared texts, one behind the other
  std::vector<std::size_t> string_ends;
};

/// Throws RecordingError for what is no workbook of this format.
[[nodiscard]] Workbook read_workbook(ZipParts& parts, const std::string& file);

/// The sheet called `wanted`, or its number ("#2"); empty: the first one that is not hidden, with a
/// note of the others. Throws RecordingError when there is none.
[[nodiscard]] const WorkbookSheet& chosen_sheet(const Workbook& workbook, const std::string& wanted,
                                                const std::string& file, std::vector<Note>& notes);

/// By the format's code, such as "dd.mm.yyyy hh:mm:ss.000" or "[h]:mm:ss".
[[nodiscard]] CellFormat cell_format(std::string_view code);

}  // namespace rigfit::signal
