#include "apps/results/text_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/scene/toml_table.h"
#include "signal/readers/csv/csv_fields.h"
#include "signal/readers/csv/csv_layout.h"
#include "signal/readers/csv/csv_table.h"
#include "signal/readers/files/mapped_file.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/units.h"

namespace rigfit::apps {
namespace {

using signal::CsvField;
using signal::FieldKind;

struct Line {
  long number = 0;
  std::string_view text;
};

/// Lines that hold something and are no remark.
std::vector<Line> lines_of(std::string_view bytes) {
  std::vector<Line> lines;
  long number = 1;
  for (std::size_t at = 0; at < bytes.size(); ++number) {
    const std::size_t end = signal::line_end(bytes, at);
    const auto text = signal::trim_blanks(bytes.substr(at, end - at));
    if (!text.empty() && text.front() != '#') lines.push_back({number, bytes.substr(at, end - at)});
    at = signal::next_line(bytes, end);
  }
  return lines;
}

/// The lines alone, each with its end: what the layout is found from.
std::string joined(const std::vector<Line>& lines) {
  std::string text;
  for (const auto& line : lines) text.append(line.text).push_back('\n');
  return text;
}

/// The first line as names: where words are more than numbers, the layout of a recording is not
/// found.
signal::CsvLayout plain_layout(const std::vector<Line>& lines) {
  signal::CsvLayout layout;
  const auto header = lines.front().text;
  layout.dialect.separator = header.find(';') != std::string_view::npos    ? ';'
                             : header.find('\t') != std::string_view::npos ? '\t'
                                                                           : ',';
  std::vector<CsvField> fields;
  signal::split_fields(header, layout.dialect, fields);
  for (const auto& field : fields) {
    const auto title = signal::split_title(signal::to_utf8(field.text));
    layout.columns.push_back({title.name, title.unit});
  }
  layout.body_line = 2;
  layout.has_names = true;
  return layout;
}

TextTable::Column column_of(const signal::CsvColumn& from) {
  TextTable::Column column{from.name, from.unit};
  if (from.unit.empty()) return column;
  const auto unit = signal::parse_unit(from.unit);
  if (from.name.ends_with(from.unit)) {
    // Behind an underscore many a word looks like a unit ("f_in"): forces and frequencies only.
    if (unit && (unit->si == "N" || unit->si == "Hz")) column.si_per_number = unit->factor;
    return column;
  }
  column.known_unit = unit.has_value();
  if (!unit) return column;
  column.si_per_number = unit->factor;
  column.si_offset = unit->offset;
  return column;
}

class Reader {
 public:
  Reader(std::string_view bytes, const std::string& file, ShortRows short_rows)
      : lines_(lines_of(bytes)), short_rows_(short_rows) {
    table_.file = file;
  }

  TextTable run() {
    std::size_t first = find_layout(lines_);
    table_.decimal = layout_.dialect.decimal;
    // A line with a word among its numbers may have been taken for a part of the header.
    const std::size_t body = first;
    const std::size_t width = cells_in(lines_[body]);
    while (first > 1 && is_row(lines_[first - 1], width)) --first;
    if (first < body) {
      std::vector<Line> without(lines_.begin(),
                                lines_.begin() + static_cast<std::ptrdiff_t>(first));
      without.insert(without.end(), lines_.begin() + static_cast<std::ptrdiff_t>(body),
                     lines_.end());
      first = find_layout(without);
    }
    for (const auto& column : layout_.columns) table_.columns.push_back(column_of(column));
    while (!table_.columns.empty() && table_.columns.back().name.empty()) table_.columns.pop_back();
    if (!layout_.has_names || table_.columns.empty() || first == 0) {
      throw error(lines_.front().number, "names no columns above its numbers",
                  "give a header line and rows of numbers");
    }
    table_.header_line = lines_[first - 1].number;
    for (std::size_t k = first; k < lines_.size(); ++k) add(lines_[k]);
    return std::move(table_);
  }

 private:
  [[nodiscard]] model::SceneError error(long line, const std::string& problem,
                                        const char* remedy) const {
    return {{table_.file, line, 0, ""}, problem, remedy};
  }
  [[nodiscard]] model::SceneError no_rows() const {
    return error(0, "holds no rows", "give a header line and rows of numbers");
  }

  /// Index of the first line of numbers.
  std::size_t find_layout(const std::vector<Line>& lines) {
    if (lines.size() < 2) throw no_rows();
    try {
      layout_ = signal::find_csv_layout(joined(lines), table_.file);
    } catch (const signal::RecordingError&) {
      layout_ = plain_layout(lines);
    }
    return static_cast<std::size_t>(layout_.body_line - 1);
  }

  std::size_t cells_in(const Line& line) {
    signal::split_fields(line.text, layout_.dialect, fields_);
    return fields_.size();
  }

  bool is_row(const Line& line, std::size_t width) {
    return cells_in(line) == width &&
           std::any_of(fields_.begin(), fields_.end(), [&](const CsvField& field) {
             return signal::kind_of(field.text, table_.decimal) == FieldKind::number;
           });
  }

  void add(const Line& line) {
    signal::split_fields(line.text, layout_.dialect, fields_);
    while (fields_.size() > table_.columns.size() && fields_.back().text.empty()) {
      fields_.pop_back();
    }
    const bool fill = short_rows_ == ShortRows::filled && fields_.size() < table_.columns.size();
    if (!fill && fields_.size() != table_.columns.size()) {
      throw error(
          line.number,
          fmt::format("has {} values, the header {}", fields_.size(), table_.columns.size()),
          "give every row a value or a blank for each column");
    }
    TextTable::Row row{line.number, {}};
    for (const auto& field : fields_) row.cells.push_back(signal::to_utf8(field.text));
    row.cells.resize(table_.columns.size());
    table_.rows.push_back(std::move(row));
  }

  std::vector<Line> lines_;
  ShortRows short_rows_;
  signal::CsvLayout layout_;
  TextTable table_;
  std::vector<CsvField> fields_;
};

}  // namespace

std::ptrdiff_t TextTable::find(const std::string& title) const {
  const auto at = [&](auto&& matches) {
    const auto found = std::find_if(columns.begin(), columns.end(),
                                    [&](const Column& column) { return matches(column.name); });
    return found == columns.end() ? std::ptrdiff_t{-1} : found - columns.begin();
  };
  const auto is = [](const std::string& wanted) {
    return [lower = signal::lower_case(wanted)](const std::string& name) {
      return signal::lower_case(name) == lower;
    };
  };
  auto index = at([&](const std::string& name) { return name == title; });
  if (index < 0) index = at(is(title));
  if (index < 0) index = at(is(signal::split_title(title).name));
  return index;
}

std::size_t TextTable::column(const std::string& title) const {
  if (const auto index = find(title); index >= 0) return static_cast<std::size_t>(index);
  std::vector<std::string> names;
  for (const auto& one : columns) names.push_back(one.name);
  const auto nearest = model::nearest_word(title, names);
  throw model::SceneError({file, header_line, 0, ""}, "has no column \"" + title + "\"",
                          nearest ? "did you mean \"" + *nearest + "\"?"
                                  : fmt::format("its columns: \"{}\"", fmt::join(names, "\", \"")));
}

double TextTable::number(const Row& row, const std::string& title) const {
  const auto index = find(title);
  return index < 0 ? std::numeric_limits<double>::quiet_NaN()
                   : number(row, static_cast<std::size_t>(index));
}

std::string TextTable::text(const Row& row, const std::string& title) const {
  const auto index = find(title);
  if (index < 0) return {};
  const auto& cell = row.cells[static_cast<std::size_t>(index)];
  const auto begin = cell.find_first_not_of(" \t"), end = cell.find_last_not_of(" \t");
  return begin == std::string::npos ? std::string() : cell.substr(begin, end - begin + 1);
}

double TextTable::number(const Row& row, std::size_t column) const {
  const std::string& cell = row.cells[column];
  const auto& of = columns[column];
  const auto fail = [&](const std::string& problem, const std::string& remedy) {
    throw model::SceneError({file, row.line, static_cast<long>(column + 1), ""}, problem, remedy);
  };
  const bool infinite = signal::lower_case(cell).find("inf") != std::string::npos;
  if (cell.empty() || (signal::is_missing_word(cell) && !infinite)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  double value = 0;
  if (!signal::parse_whole_number(cell, decimal, value) || !std::isfinite(value)) {
    fail(fmt::format("\"{}\" in column \"{}\" is not a number", cell, of.name),
         fmt::format("write numbers with a decimal {} as the others, and nothing where there is no "
                     "value",
                     decimal == ',' ? "comma" : "point"));
  }
  if (!of.known_unit) {
    fail(fmt::format("the unit \"{}\" of column \"{}\" is not known", of.unit, of.name),
         "give the column in SI units");
  }
  return value * of.si_per_number + of.si_offset;
}

TextTable parse_text_table(std::string_view bytes, const std::string& file, ShortRows short_rows) {
  std::string converted;
  try {
    const auto text = signal::text_without_mark(bytes, converted, file);
    return Reader(text, file, short_rows).run();
  } catch (const signal::RecordingError& error) {
    throw model::SceneError({file, 0, 0, ""}, "is no table of text", "give a CSV table");
  }
}

TextTable read_text_table(const std::filesystem::path& path, ShortRows short_rows) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw model::SceneError({path.string(), 0, 0, ""}, "there is no such file",
                            "check the path (in a campaign it starts at its folder)");
  }
  if (std::filesystem::file_size(path, error) == 0) return parse_text_table("", path.string());
  try {
    const signal::MappedFile file(path);
    return parse_text_table(file.bytes(), path.string(), short_rows);
  } catch (const signal::RecordingError&) {
    throw model::SceneError({path.string(), 0, 0, ""}, "cannot be read", "check its permissions");
  }
}

}  // namespace rigfit::apps
