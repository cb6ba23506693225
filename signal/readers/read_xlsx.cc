// A sheet as a table of text: one line a row, so that line 7 is row 7, its fields parted by
// semicolons, numbers with as many digits as give them back exactly; then the rules of tables of
// text.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <minizip/unzip.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <pugixml.hpp>
#include <regex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "signal/readers/csv_fields.h"
#include "signal/readers/csv_table.h"
#include "signal/readers/read_recording.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/recording_time.h"

namespace rigfit::signal {
namespace {

// Four million cells; as a tree in memory a part is up to 10 times as large.
constexpr std::size_t kLargestPart = std::size_t{1} << 27;
constexpr long kSheetRows = 1 << 20, kSheetColumns = 1 << 14;  // Excel's
// Fields of the table, empty ones too: two cells in opposite corners must not fill the memory.
constexpr long kMostFields = 1L << 27;

/// Without namespace prefixes: "x:row" is a "row".
bool is_called(const pugi::xml_node& node, std::string_view name) {
  const std::string_view full = node.name();
  return full.substr(full.find(':') + 1) == name;
}

pugi::xml_node child(const pugi::xml_node& node, std::string_view name) {
  return node.find_child([&](const auto& one) { return is_called(one, name); });
}

/// A string with its runs of fonts put together; readings above characters (rPh) are left out.
std::string string_of(const pugi::xml_node& item) {
  std::string text;
  for (const auto& one : item.children()) {
    if (is_called(one, "t")) text += one.text().get();
    if (is_called(one, "r")) text += child(one, "t").text().get();
  }
  return text;
}

/// Whether a format's code, such as "dd.mm.yyyy hh:mm" or "[h]:mm:ss", shows a date or a time.
bool shows_clock(const std::string& code) {
  constexpr std::size_t kLongest = 255;  // Excel's
  // Words, a character shown or kept free, colours, conditions and languages, further sections.
  static const std::regex kNoClock(R"("[^"]*"|\\.|[_*].|\[(?![hms]+\])[^\]]*\]|;.*)");
  const std::string shown =
      std::regex_replace(lower_case(std::string_view(code).substr(0, kLongest)), kNoClock, "");
  return shown.find_first_of("ydhms") != std::string::npos;
}

/// Text as a field: in quotes where it would end there or be taken as a remark.
std::string words(const std::string& text) {
  std::string plain(trim_blanks(to_utf8(text)));
  if (plain.find_first_of(";\"") == std::string::npos && !plain.starts_with('#') &&
      !plain.starts_with('%')) {
    return plain;
  }
  return "\"" + std::regex_replace(plain, std::regex("\""), "\"\"") + "\"";
}

struct Sheet {
  std::string name;
  std::string part;  ///< in the archive; empty: no sheet of cells (a chart)
  bool hidden = false;
};

/// The sheet called `wanted`, or its number ("#2"); empty: the first one that is not hidden, with a
/// note of the others.
const Sheet& chosen(const std::vector<Sheet>& sheets, const std::string& wanted,
                    const std::string& file, std::vector<Note>& notes) {
  std::vector<std::string> names;
  names.reserve(sheets.size());
  for (const auto& sheet : sheets) names.push_back(sheet.name);
  for (std::size_t k = 0; k < sheets.size(); ++k) {
    const Sheet& sheet = sheets[k];
    const bool meant = wanted.empty() ? !sheet.hidden
                                      : sheet.name == wanted || wanted == fmt::format("#{}", k + 1);
    if (sheet.part.empty() || !meant) continue;
    if (wanted.empty() && sheets.size() > 1) {
      add_note(
          notes, "assumed", "",
          "Give --sheet NAME (key sheet) if \"{}\" is not the sheet to read: the workbook has {}",
          sheet.name, listed(names));
    }
    return sheet;
  }
  throw file_error(file,
                   wanted.empty() ? "the workbook has no visible sheet of cells"
                                  : "the workbook has no sheet of that name with cells",
                   "give --sheet NAME (key sheet): it has " + listed(names), wanted);
}

class Workbook {
 public:
  explicit Workbook(const std::filesystem::path& path)
      : file_(path.string()), zip_(::unzOpen64(path.c_str()), ::unzClose) {
    if (zip_ == nullptr) throw damaged("list of parts");
    std::map<std::string, std::string> parts;  // sheets by the identifiers of their relations
    const auto relations = document("xl/_rels/workbook.xml.rels");
    for (const auto& one : relations.document_element().children()) {
      const std::string_view type = one.attribute("Type").as_string();
      const std::string target = one.attribute("Target").as_string();
      const std::string part = target.starts_with('/') ? target.substr(1) : "xl/" + target;
      if (type.ends_with("/worksheet")) parts[one.attribute("Id").as_string()] = part;
      if (type.ends_with("/styles")) read_styles(document(part).document_element());
      if (!type.ends_with("/sharedStrings")) continue;
      const auto strings = document(part);
      for (const auto& item : strings.document_element().children()) {
        if (is_called(item, "si")) strings_.push_back(string_of(item));
      }
    }
    const auto book = document("xl/workbook.xml");
    const pugi::xml_node root = book.document_element();
    for (const auto& one : child(root, "sheets").children()) {
      const std::string_view state = one.attribute("state").as_string("visible");
      const auto id = one.find_attribute(
          [](const auto& a) { return std::string_view(a.name()).ends_with(":id"); });
      sheets_.push_back(
          {one.attribute("name").as_string(), parts[id.as_string()], state != "visible"});
    }
  }

  [[nodiscard]] const std::vector<Sheet>& sheets() const { return sheets_; }

  /// The sheet's rows, each with as many fields as the widest row of numbers has.
  [[nodiscard]] std::string text_of(const Sheet& sheet) const {
    const std::vector<Cell> cells = cells_of(sheet);
    long first_row = 0, first = kSheetColumns, last = 0;  // first row and last column of numbers
    for (const Cell& cell : cells) {
      first = std::min(first, cell.column);
      if (!cell.is_number) continue;
      if (first_row == 0) first_row = cell.row;
      last = std::max(last, cell.column);
    }
    if (first_row == 0) {
      throw file_error(file_, "the sheet holds no numbers",
                       "give the sheet with the recording: --sheet NAME (key sheet)", sheet.name);
    }
    if (cells.back().row * (last - first + 1) > kMostFields) {
      throw refusal(sheet, cells.back(), "",
                    "stands so far from the others that there are over 134 million fields",
                    "delete what stands far from the table");
    }
    std::string text;
    auto cell = cells.begin();
    for (long row = 1; row <= cells.back().row; ++row) {
      std::vector<std::string> fields;
      for (; cell != cells.end() && cell->row == row; ++cell) {
        fields.resize(static_cast<std::size_t>(cell->column - first + 1));
        fields.back() = cell->text;
      }
      // An empty row above the numbers is nothing, among them it is a sample without values.
      if (fields.empty() && row > first_row) fields = {"\"\""};
      if (!fields.empty()) {
        fields.resize(std::max(fields.size(), static_cast<std::size_t>(last - first + 1)));
      }
      text += fmt::format("{}\n", fmt::join(fields, ";"));
    }
    return text;
  }

 private:
  struct Cell {
    long row = 0, column = 0;  ///< from 1
    std::string name, text;
    bool is_number = false;
  };

  [[nodiscard]] RecordingError damaged(const std::string& part) const {
    return file_error(file_, "is a workbook (.xlsx) with a damaged, encrypted or missing part",
                      "copy the file again, or open it in a spreadsheet program and save it as "
                      ".xlsx without a password",
                      part);
  }

  /// A part of the archive.
  [[nodiscard]] pugi::xml_document document(const std::string& part) const {
    unz_file_info64 info{};
    if (::unzLocateFile(zip_.get(), part.c_str(), 1) != UNZ_OK ||
        ::unzGetCurrentFileInfo64(zip_.get(), &info, nullptr, 0, nullptr, 0, nullptr, 0) !=
            UNZ_OK) {
      throw damaged(part);
    }
    if (info.uncompressed_size > kLargestPart) {
      throw file_error(file_, "is a workbook (.xlsx) that unpacks to more than is read (128 MiB)",
                       "save the sheet as CSV, or split it", part);
    }
    std::string text(info.uncompressed_size, '\0');
    const auto size = static_cast<unsigned>(text.size());
    // The check sum is looked at when a part that was read to its stated end is closed.
    const bool whole =
        (info.flag & 1U) == 0 && ::unzOpenCurrentFile(zip_.get()) == UNZ_OK &&
        ::unzReadCurrentFile(zip_.get(), text.data(), size) == static_cast<int>(size) &&
        ::unzCloseCurrentFile(zip_.get()) == UNZ_OK;
    pugi::xml_document parsed;
    if (!whole || !parsed.load_buffer(text.data(), text.size())) throw damaged(part);
    return parsed;
  }

  void read_styles(const pugi::xml_node& styles) {
    std::map<unsigned, bool> codes;
    for (const auto& one : child(styles, "numFmts").children()) {
      codes[one.attribute("numFmtId").as_uint()] =
          shows_clock(one.attribute("formatCode").as_string());
    }
    for (const auto& one : child(styles, "cellXfs").children()) {
      const unsigned id = one.attribute("numFmtId").as_uint();
      const auto coded = codes.find(id);
      // Formats without a code: ECMA-376, 18.8.30.
      clocks_.push_back(coded != codes.end() ? coded->second
                                             : (14 <= id && id <= 22) || (45 <= id && id <= 47));
    }
  }

  [[nodiscard]] RecordingError refusal(const Sheet& sheet, const Cell& cell, std::string value,
                                       const std::string& problem, std::string remedy) const {
    return {{file_, cell.row, 0, "", std::move(value)},
            "cell " + sheet.name + "!" + cell.name + " " + problem,
            std::move(remedy)};
  }

  /// The cells that hold something, row by row.
  [[nodiscard]] std::vector<Cell> cells_of(const Sheet& sheet) const {
    const auto parsed = document(sheet.part);
    std::vector<Cell> cells;
    long row = 0;
    for (const auto& line : child(parsed.document_element(), "sheetData").children()) {
      const long number = line.attribute("r") ? line.attribute("r").as_llong() : row + 1;
      if (number <= row || number > kSheetRows) throw damaged(sheet.part);
      row = number;
      long column = 0;
      for (const auto& one : line.children()) {
        if (!is_called(one, "c")) continue;
        Cell cell{row, 0, one.attribute("r").as_string(), "", false};
        for (const char c : cell.name) {
          if (c >= 'A' && c <= 'Z' && cell.column < kSheetColumns) {
            cell.column = 26 * cell.column + (c - 'A' + 1);
          }
        }
        const std::size_t letters = cell.name.find_first_of("0123456789");
        if (cell.name.empty()) {
          cell.column = column + 1;
          cell.name = fmt::format("R{}C{}", row, cell.column);
        } else if (letters == std::string::npos ||
                   cell.name.substr(letters) != std::to_string(row)) {
          throw damaged(sheet.part);
        }
        if (cell.column <= column || cell.column > kSheetColumns) {
          throw damaged(sheet.part);
        }
        column = cell.column;
        read_cell(sheet, one, cell);
        if (!cell.text.empty()) cells.push_back(std::move(cell));
      }
    }
    return cells;
  }

  void read_cell(const Sheet& sheet, const pugi::xml_node& node, Cell& cell) const {
    const std::string_view type = node.attribute("t").as_string("n");
    const std::string value(trim_blanks(child(node, "v").text().get()));
    const auto refuse = [&](const char* problem, const char* remedy) {
      throw refusal(sheet, cell, value, problem, remedy);
    };
    if (value.empty() && child(node, "f") && type != "str") {
      refuse("has a formula that was saved without its value",
             "open the workbook in a spreadsheet program, which computes it, and save it again");
    }
    double number = 0;
    if (type == "inlineStr") {
      cell.text = words(string_of(child(node, "is")));
    } else if (type == "str" || type == "d" || value == "#N/A") {
      cell.text = words(value);
    } else if (type == "b") {
      cell.text = value == "1" ? "TRUE" : "FALSE";
    } else if (type == "e") {
      refuse("holds an error instead of a value",
             "correct the formula, or empty the cell where there is no value");
    } else if (value.empty()) {
      return;
    } else if (!parse_whole_number(value, '.', number) || !std::isfinite(number) ||
               (type == "s" && !(number >= 0 && number < static_cast<double>(strings_.size())))) {
      refuse("is damaged", "open the workbook in a spreadsheet program and save it again");
    } else if (type == "s") {
      cell.text = words(strings_[static_cast<std::size_t>(number)]);
    } else {
      const unsigned style = node.attribute("s").as_uint();
      if (style < clocks_.size() && clocks_[style]) {
        refuse("is a date or a time of day",
               "write times in seconds: =(A2-A$2)*86400 in a column with the format of a number");
      }
      cell.is_number = true;
      cell.text = fmt::format("{}", number);
    }
  }

  std::string file_;
  std::unique_ptr<void, int (*)(void*)> zip_;  ///< the archive of parts
  std::vector<Sheet> sheets_;
  std::vector<std::string> strings_;
  std::vector<bool> clocks_;  ///< by the number that cells give as their style: shows a time
};

}  // namespace

CsvTable read_xlsx_columns(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string file = path.string();
  const Workbook workbook(path);
  std::vector<Note> notes;
  const Sheet& sheet = chosen(workbook.sheets(), options.sheet, file, notes);
  const std::string text = workbook.text_of(sheet);
  ReadOptions as_written = options;
  as_written.separator = ';';
  as_written.decimal = '.';
  as_written.done_with = nullptr;
  try {
    CsvTable table = read_csv_columns(text, file, as_written);
    table.notes.insert(table.notes.begin(), notes.begin(), notes.end());
    return table;
  } catch (const RecordingError& error) {
    RecordingPlace where = error.where();
    where.column = 0;  // in the line of text, which nobody sees
    throw RecordingError(where, error.problem(), error.remedy());
  }
}

Recording read_xlsx(std::string_view, const std::filesystem::path& path,
                    const ReadOptions& options) {
  return recording_of_table(read_xlsx_columns(path, options), path, "xlsx", options);
}

}  // namespace rigfit::signal
