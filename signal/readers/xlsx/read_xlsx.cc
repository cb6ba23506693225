#include "signal/readers/files/read_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <pugixml.hpp>
#include <regex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "signal/readers/csv/csv_fields.h"
#include "signal/readers/csv/csv_layout.h"
#include "signal/readers/csv/csv_table.h"
#include "signal/readers/xlsx/workbook.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/recording_time.h"

namespace rigfit::signal {
namespace {

// ---- A sheet as a table of text: one line a row, so that line 7 is row 7, its fields parted by
// semicolons, numbers with as many digits as give them back exactly. Formulas give the values saved
// with them. Cells without a value are empty fields. Refused, with the cell: an error (#DIV/0! ...;
// #N/A is a missing value), a formula saved without its value, a date that programs read
// differently, and a number that is none.

/// 1-based; 0: none.
struct CellPlace {
  long row = 0, column = 0;
};

/// "B7".
std::string cell_name(const CellPlace& place) {
  std::string letters;
  for (long rest = place.column; rest > 0; rest = (rest - 1) / 26) {
    letters.insert(letters.begin(), static_cast<char>('A' + (rest - 1) % 26));
  }
  return letters + std::to_string(place.row);
}

struct SheetText {
  std::string file;
  std::string sheet;
  std::string text;
  long first_column = 1;  ///< in the sheet: the first field of each line
  /// Cells of text that read as numbers, row by row, with their text.
  std::vector<std::pair<CellPlace, std::string>> number_texts;
  std::vector<std::pair<CellPlace, CellPlace>> merged;  ///< first and last cells

  /// The place of a cell, or of a row where the column is 0.
  [[nodiscard]] RecordingError refusal(const CellPlace& place, std::string value,
                                       std::string problem, std::string remedy) const;
};

RecordingError SheetText::refusal(const CellPlace& place, std::string value, std::string problem,
                                  std::string remedy) const {
  const bool plain = std::all_of(sheet.begin(), sheet.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c >= 0x80;
  });
  std::string cell = plain ? sheet : "'" + sheet + "'";
  if (place.row > 0 && place.column > 0) cell += "!" + cell_name(place);
  if (place.row > 0 && place.column == 0) cell += ", row " + std::to_string(place.row);
  return {{file, place.row, place.column, "", std::move(value), std::move(cell)},
          std::move(problem),
          std::move(remedy)};
}

constexpr long kSheetRows = 1 << 20;     // Excel's
constexpr long kSheetColumns = 1 << 14;  // Excel's: XFD
// Fields of the table, empty ones too, so that two cells in opposite corners of a sheet do not fill
// the memory: every row of 128 columns.
constexpr long kMostFields = 1L << 27;

/// "B7" to {7, 2}; {0, 0} when it is no cell's name.
CellPlace place_named(std::string_view name) {
  CellPlace place;
  std::size_t at = 0;
  for (; at < name.size() && name[at] >= 'A' && name[at] <= 'Z' && at < 3; ++at) {
    place.column = 26 * place.column + (name[at] - 'A' + 1);
  }
  const std::string_view digits = name.substr(at);
  if (place.column == 0 || digits.empty() || digits.size() > 7) return {};
  for (const char c : digits) {
    if (c < '0' || c > '9') return {};
    place.row = 10 * place.row + (c - '0');
  }
  return place;
}

class SheetParser {
 public:
  SheetParser(ZipParts& parts, const Workbook& workbook, const WorkbookSheet& sheet,
              const std::string& file)
      : parts_(parts), workbook_(workbook), sheet_(sheet) {
    result_.file = file;
    result_.sheet = sheet.name;
  }

  /// Throws RecordingError, also for a sheet without numbers.
  SheetText parse() {
    const std::string rest =
        parts_.in_pieces(sheet_.part, "sheetData", "row", [&](const auto& row) { parse_row(row); });
    static const std::regex kMerged(R"re(mergeCell ref="(\w+):(\w+)")re");
    for (std::sregex_iterator one(rest.begin(), rest.end(), kMerged), end; one != end; ++one) {
      result_.merged.emplace_back(place_named((*one)[1].str()), place_named((*one)[2].str()));
    }
    put_together();
    return std::move(result_);
  }

 private:
  /// Puts the rows together, each with as many fields as the widest row of numbers has.
  void put_together() {
    long first_row = 0, width = 0;
    for (const auto& row : rows_) {
      if (!row.numbers) continue;
      if (first_row == 0) first_row = row.number;
      width = std::max(width, row.columns);
    }
    if (first_row == 0) {
      throw result_.refusal({}, "", "the sheet holds no numbers",
                            "give the sheet with the recording: --sheet NAME (key sheet)");
    }
    if (rows_.back().number * (width - first_column_ + 1) > kMostFields) {
      throw result_.refusal({rows_.back().number, width}, "",
                            "the sheet's cells are scattered over more than 134 million fields",
                            "delete what stands far from the table");
    }
    result_.first_column = first_column_;
    std::string text;
    text.reserve(cells_.size() + rows_.size());
    long number = 1;
    for (std::size_t k = 0; k < rows_.size(); ++k, ++number) {
      const Row& row = rows_[k];
      for (; number < row.number; ++number) {
        // An empty row above the numbers is nothing, among them it is a sample without values.
        if (number > first_row) {
          text += "\"\"";
          text.append(static_cast<std::size_t>(width - first_column_), ';');
        }
        text += '\n';
      }
      const std::size_t end = k + 1 < rows_.size() ? rows_[k + 1].begin : cells_.size();
      const auto skipped = static_cast<std::size_t>(first_column_ - 1);
      text.append(cells_, row.begin + skipped, end - row.begin - skipped);
      if (row.columns < width) text.append(static_cast<std::size_t>(width - row.columns), ';');
      text += '\n';
    }
    result_.text = std::move(text);
  }

  /// A row with at least one value; its fields, from column A on, are in `cells_`.
  struct Row {
    std::size_t begin = 0;
    long number = 0, columns = 0;
    bool numbers = false;
  };

  void parse_row(const pugi::xml_node& node) {
    const pugi::xml_attribute given = node.attribute("r");
    const long number = given ? given.as_llong() : row_ + 1;
    if (number <= row_ || number > kSheetRows) throw parts_.damaged(sheet_.part);
    row_ = number;
    Row row{cells_.size(), number, 0, false};
    long column = 0;
    for (const auto& cell : node.children()) {
      if (!has_local_name(cell.name(), "c")) continue;
      const pugi::xml_attribute name = cell.attribute("r");
      const CellPlace place = name ? place_named(name.as_string()) : CellPlace{number, column + 1};
      if (place.row != number || place.column <= column || place.column > kSheetColumns) {
        throw parts_.damaged(sheet_.part);
      }
      column = place.column;
      bool is_number = false;
      const std::string text = text_of(cell, place, is_number);
      if (text.empty()) continue;
      cells_.append(static_cast<std::size_t>(column - std::max(row.columns, 1L)), ';');
      cells_ += text;
      if (row.columns == 0) first_column_ = std::min(first_column_, column);
      row.columns = column;
      row.numbers |= is_number;
    }
    if (row.columns == 0) return;
    rows_.push_back(row);
  }

  std::string text_of(const pugi::xml_node& cell, const CellPlace& place, bool& is_number) {
    const std::string_view type = cell.attribute("t").as_string("n");
    if (type == "inlineStr") return words(string_of(local_child(cell, "is")), place);
    const pugi::xml_node saved = local_child(cell, "v");
    const std::string_view value = trim_blanks(saved.text().get());
    if (local_child(cell, "f") && (!saved || (value.empty() && type != "str"))) {
      throw result_.refusal(place, "", "the formula was saved without its value",
                            "open the workbook in a spreadsheet program, which computes it, and "
                            "save it again");
    }
    if (value.empty()) return {};
    if (type == "str") return words(std::string(value), place);
    if (type == "d") return std::string(value);
    if (type == "b") return value == "1" ? "TRUE" : "FALSE";
    if (type == "e") {
      if (value == "#N/A") return "\"#N/A\"";
      throw result_.refusal(place, std::string(value), "holds an error instead of a value",
                            "correct the formula, or empty the cell where there is no value");
    }
    double number = 0;
    const bool good = parse_whole_number(value, '.', number) && std::isfinite(number);
    if (type == "s" && good && number >= 0 && number < static_cast<double>(workbook_.strings())) {
      return words(std::string(workbook_.string(static_cast<std::size_t>(number))), place);
    }
    if (type != "n" || !good) {
      throw result_.refusal(place, std::string(value), "the cell's value is damaged",
                            "open the workbook in a spreadsheet program and save it again");
    }
    is_number = true;
    return number_text(number, cell.attribute("s").as_uint(), place);
  }

  std::string number_text(double number, unsigned style, const CellPlace& place) {
    const CellFormat format =
        style < workbook_.formats.size() ? workbook_.formats[style] : CellFormat::number;
    if (format == CellFormat::number) return fmt::format("{}", number);
    const auto text = clock_text(number, format, workbook_.from_1904);
    if (!text) {
      throw result_.refusal(
          place, fmt::format("{}", number),
          "is shown as a date that programs read differently (before 1900-03-01), or as none",
          "write times as seconds, or give the cell the format of a time of day or a number");
    }
    return *text;
  }

  /// Text as a field: in quotes where it would end there or be taken as a remark.
  std::string words(std::string text, const CellPlace& place) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
    text = std::string(trim_blanks(text));
    double number = 0;
    if (parse_whole_number(text, '.', number) || parse_whole_number(text, ',', number)) {
      result_.number_texts.emplace_back(place, text);
    }
    if (text.find_first_of(";\"") == std::string::npos && !text.starts_with('#') &&
        !text.starts_with('%')) {
      return text;
    }
    for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2) {
      text.insert(at, 1, '"');
    }
    return "\"" + text + "\"";
  }

  ZipParts& parts_;
  const Workbook& workbook_;
  const WorkbookSheet& sheet_;
  SheetText result_;
  std::string cells_;
  std::vector<Row> rows_;
  long row_ = 0;
  long first_column_ = kSheetColumns;
};

// ---- The sheet as a table by the rules of tables of text

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
  const bool is_text =
      std::any_of(sheet.number_texts.begin(), sheet.number_texts.end(), [&](const auto& one) {
        return one.first.row == place.row && one.first.column == place.column;
      });
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
/// and to all of them on the screen. A heading alone in its row above the titles may be merged.
void refuse_merged(const SheetText& sheet, long first_row, long last_row) {
  for (const auto& [first, last] : sheet.merged) {
    std::vector<CsvField> fields;
    split_fields(row_text(sheet.text, first.row), kSheetDialect, fields);
    const bool alone =
        std::ranges::count_if(fields, [](const auto& one) { return !one.text.empty(); }) < 2;
    if (first.row > last_row || (alone && last.row < first_row - 1)) continue;
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
  for (const auto& [place, text] : sheet.number_texts) {
    if (place.row >= first_row && place.row <= last_row) throw stored_as_text(sheet, place, text);
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
  const SheetText sheet = SheetParser(parts, workbook, chosen, file).parse();
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
