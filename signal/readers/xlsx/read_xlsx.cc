#include "signal/readers/xlsx/read_xlsx.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "signal/readers/csv/csv_fields.h"
#include "signal/readers/csv/csv_layout.h"
#include "signal/readers/csv/csv_table.h"
#include "signal/readers/xlsx/sheet_text.h"
#include "signal/readers/xlsx/workbook.h"
#include "signal/readers/xlsx/zip_parts.h"
#include "signal/recording/recording_error.h"

namespace rigfit::signal {
namespace {

constexpr CsvDialect kSheetDialect{';', '.'};

std::string_view row_text(std::string_view text, long row) {
  std::size_t at = 0;
  for (long k = 1; k < row; ++k) at = next_line(text, line_end(text, at));
  return text.substr(at, line_end(text, at) - at);
}

RecordingError stored_as_text(const SheetText& sheet, const CellPlace& place, std::string value) {
  return sheet.refusal(
      place, std::move(value), "a number stored as text",
      "convert the cells to numbers (Excel: Data, Text to Columns), or leave them empty");
}

/// The table's refusal with the sheet's cell in place of line and character.
RecordingError by_cell(const RecordingError& error, const SheetText& sheet) {
  CellPlace place{error.where().line, 0};
  if (place.row > 0 && error.where().column > 0) {
    std::vector<CsvField> before;
    const auto row = row_text(sheet.text, place.row);
    split_fields(row.substr(0, static_cast<std::size_t>(error.where().column)), kSheetDialect,
                 before);
    place.column = sheet.first_column + static_cast<long>(before.size()) - 1;
  }
  const bool is_text = std::any_of(
      sheet.number_texts.begin(), sheet.number_texts.end(),
      [&](const auto& one) { return one.row == place.row && one.column == place.column; });
  if (is_text) return stored_as_text(sheet, place, error.where().value);
  auto where = sheet.refusal(place, error.where().value, "", "").where();
  where.channel = error.where().channel;
  return {where, error.problem(), error.remedy()};
}

/// "line 7" and "near line 7" in notes.
void name_rows(std::vector<Note>& notes) {
  for (auto& note : notes) {
    const std::size_t at = note.where.find("line ");
    if (at == 0 || (at != std::string::npos && note.where.starts_with("near "))) {
      note.where.replace(at, 4, "row");
    }
  }
}

/// A title over several columns, or a value over several rows, belongs to one of them in the file
/// and to all of them on the screen.
void refuse_merged(const SheetText& sheet, long first_row, long last_row) {
  for (const auto& [first, last] : sheet.merged) {
    if (first.row > last_row) continue;
    // Above the line of titles, and nothing beside it: a heading.
    bool alone = last.row < first_row - 1;
    for (long row = first.row; alone && row <= last.row; ++row) {
      std::vector<CsvField> fields;
      split_fields(row_text(sheet.text, row), kSheetDialect, fields);
      for (std::size_t k = 0; k < fields.size(); ++k) {
        const long column = sheet.first_column + static_cast<long>(k);
        alone &= fields[k].text.empty() || (column >= first.column && column <= last.column);
      }
    }
    if (alone) continue;
    throw sheet.refusal(first, cell_name(first) + ":" + cell_name(last),
                        "merged cells in the table or its titles",
                        "unmerge them and give each column its own title and each row its values");
  }
}

CsvTable table_of(const SheetText& sheet, ReadOptions options, std::vector<Note> notes) {
  options.separator = kSheetDialect.separator;
  options.decimal = kSheetDialect.decimal;
  CsvTable table = read_csv_columns(sheet.text, sheet.file, {}, options);
  const long first_row = table.layout.body_line;
  const long rows = table.channels.empty() ? 0 : table.channels.front().samples.size();
  const long last_row = first_row + rows - 1;
  refuse_merged(sheet, first_row, last_row);
  for (const auto& place : sheet.number_texts) {
    if (place.row < first_row || place.row > last_row) continue;
    std::vector<CsvField> fields;
    split_fields(row_text(sheet.text, place.row), kSheetDialect, fields);
    const auto at = static_cast<std::size_t>(place.column - sheet.first_column);
    throw stored_as_text(sheet, place, std::string(fields[at].text));
  }
  if (sheet.percent.row >= first_row && sheet.percent.row <= last_row) {
    notes.push_back({"assumed",
                     "Check the unit: numbers shown in percent are read as they are saved (50 % is "
                     "0.5)",
                     cell_name(sheet.percent)});
  }
  if (sheet.hidden_rows > 0) {
    notes.push_back({"read_as",
                     std::to_string(sheet.hidden_rows) +
                         " rows that the sheet hides (by a filter?) are read like the others",
                     ""});
  }
  notes.insert(notes.end(), table.notes.begin(), table.notes.end());
  table.notes = std::move(notes);
  return table;
}

/// `use` of the table, its refusals with their cells.
template <typename Use>
auto with_table(const std::filesystem::path& path, const ReadOptions& options, Use&& use) {
  const std::string file = path.string();
  ZipParts parts(path);
  const Workbook workbook = read_workbook(parts, file);
  std::vector<Note> notes;
  const WorkbookSheet& chosen = chosen_sheet(workbook, options.sheet, file, notes);
  const SheetText sheet = sheet_text(parts, workbook, chosen, file);
  try {
    return use(table_of(sheet, options, std::move(notes)));
  } catch (const RecordingError& error) {
    if (!error.where().cell.empty()) throw;
    throw by_cell(error, sheet);
  }
}

}  // namespace

Recording read_xlsx(const std::filesystem::path& path, const ReadOptions& options) {
  Recording recording = with_table(path, options, [&](CsvTable table) {
    return recording_of_table(std::move(table), path, "xlsx", options);
  });
  name_rows(recording.notes);
  return recording;
}

CsvTable read_xlsx_columns(const std::filesystem::path& path, const ReadOptions& options) {
  CsvTable columns = with_table(path, options, [](CsvTable table) { return table; });
  name_rows(columns.notes);
  return columns;
}

}  // namespace rigfit::signal
