#include "signal/readers/xlsx/sheet_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <pugixml.hpp>
#include <string_view>
#include <utility>

#include "signal/readers/csv/csv_fields.h"
#include "signal/readers/xlsx/clock_text.h"
#include "signal/readers/xlsx/xml_elements.h"

namespace rigfit::signal {
namespace {

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
              SheetText& result)
      : parts_(parts), workbook_(workbook), sheet_(sheet), result_(result) {}

  void parse_rows(std::string_view xml) {
    if (!document_.load_buffer(xml.data(), xml.size(), pugi::parse_default | pugi::parse_fragment,
                               pugi::encoding_utf8)) {
      throw parts_.damaged(sheet_.part);
    }
    for (const auto& row : document_.children()) parse_row(row);
  }

  void parse_tail(std::string_view xml) {
    for (std::size_t at = xml.find("mergeCell "); at != std::string_view::npos;
         at = xml.find("mergeCell ", at + 1)) {
      const std::size_t ref = xml.find("ref=\"", at);
      if (ref == std::string_view::npos) break;
      const auto text = xml.substr(ref + 5, xml.find('"', ref + 5) - ref - 5);
      const CellRange range{place_named(text.substr(0, text.find(':'))),
                            place_named(text.substr(text.find(':') + 1))};
      if (range.first.row == 0 || range.last.row == 0) throw parts_.damaged(sheet_.part);
      result_.merged.push_back(range);
    }
  }

  /// Puts the rows together, each with as many fields as the widest row of numbers has.
  void finish() {
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

 private:
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
    if (node.attribute("hidden").as_bool()) ++result_.hidden_rows;
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
    if (format == CellFormat::percent && result_.percent.row == 0) result_.percent = place;
    if (format == CellFormat::number || format == CellFormat::percent) {
      return fmt::format("{}", number);
    }
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
      result_.number_texts.push_back(place);
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
  SheetText& result_;
  pugi::xml_document document_;
  std::string cells_;
  std::vector<Row> rows_;
  long row_ = 0;
  long first_column_ = kSheetColumns;
};

}  // namespace

std::string cell_name(const CellPlace& place) {
  std::string letters;
  for (long rest = place.column; rest > 0; rest = (rest - 1) / 26) {
    letters.insert(letters.begin(), static_cast<char>('A' + (rest - 1) % 26));
  }
  return letters + std::to_string(place.row);
}

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

SheetText sheet_text(ZipParts& parts, const Workbook& workbook, const WorkbookSheet& sheet,
                     const std::string& file) {
  SheetText result;
  result.file = file;
  result.sheet = sheet.name;
  SheetParser parser(parts, workbook, sheet, result);
  const std::string tail =
      parts.in_pieces(sheet.part, "row", [&](std::string_view xml) { parser.parse_rows(xml); });
  parser.parse_tail(tail);
  parser.finish();
  return result;
}

}  // namespace rigfit::signal
