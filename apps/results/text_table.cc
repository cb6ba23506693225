#include "apps/results/text_table.h"

#include "document/toml_table.h"
#include "model/scene/scene.h"
#include "signal/readers/csv_fields.h"
#include "signal/readers/read_recording.h"

namespace rigfit::apps {
namespace {

using signal::CsvField;
using signal::FieldKind;

TextTable::Column column_of(const signal::TitledUnit& title) {
  TextTable::Column column{title.name, title.unit, signal::parse_unit(title.unit)};
  // Behind an underscore many a word looks like a unit ("f_in"): forces and frequencies only.
  const bool in_name = title.name.ends_with(title.unit);
  if (in_name && !(column.si && (column.si->si == "N" || column.si->si == "Hz"))) {
    column.si = signal::Unit();
  }
  return column;
}

bool is_number(const std::string& cell, char decimal) {
  const auto kind = signal::kind_of(cell, decimal);
  return kind == FieldKind::number || kind == FieldKind::missing;
}

/// Lines that hold something and are no remark, in cells; blank ones at the end are left out.
std::vector<TextTable::Row> lines_of(std::string_view bytes) {
  std::vector<std::pair<long, std::string_view>> lines;
  for (long number = 1; !bytes.empty(); ++number) {
    const auto text = signal::take_line(bytes), words = signal::trim_blanks(text);
    if (!words.empty() && words.front() != '#') lines.emplace_back(number, text);
  }
  signal::CsvDialect dialect{' ', '.'};
  for (const char separator : {',', '\t', ';'}) {  // the last one found wins
    const auto has = [&](const auto& line) {
      return line.second.find(separator) != line.second.npos;
    };
    if (std::ranges::any_of(lines, has)) dialect.separator = separator;
  }
  // One column may have a title with blanks.
  const bool one_column =
      dialect.separator == ' ' && !lines.empty() &&
      signal::trim_blanks(lines.back().second).find(' ') == std::string_view::npos;
  if (one_column) dialect.separator = '\t';
  std::vector<TextTable::Row> rows;
  std::vector<CsvField> fields;
  for (const auto& [line, text] : lines) {
    signal::split_fields(text, dialect, fields);
    auto& row = rows.emplace_back(TextTable::Row{line, {}});
    for (const auto& field : fields) row.cells.push_back(signal::to_utf8(field.text));
    while (!row.cells.empty() && row.cells.back().empty()) row.cells.pop_back();
  }
  return rows;
}

}  // namespace

std::ptrdiff_t TextTable::find(const std::string& title) const {
  for (const auto& wanted : {title, signal::split_title(title).name}) {
    const auto found =
        std::ranges::find(columns, signal::lower_case(wanted),
                          [](const Column& column) { return signal::lower_case(column.name); });
    if (found != columns.end()) return found - columns.begin();
  }
  return -1;
}

std::size_t TextTable::column(const std::string& title) const {
  if (const auto index = find(title); index >= 0) return static_cast<std::size_t>(index);
  std::vector<std::string> names;
  for (const auto& one : columns) names.push_back(one.name);
  const auto nearest = document::nearest_word(title, names);
  throw model::SceneError({file, header_line, 0, ""}, "has no column \"" + title + "\"",
                          nearest ? "did you mean \"" + *nearest + "\"?"
                                  : fmt::format("its columns: \"{}\"", fmt::join(names, "\", \"")));
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
  if (!of.si) {
    fail(fmt::format("the unit \"{}\" of column \"{}\" is not known", of.unit, of.name),
         "give the column in SI units");
  }
  return value * of.si->factor + of.si->offset;
}

void fill_row(const TextTable& table, const TextTable::Row& row, const describe::Options& options) {
  using describe::Json, describe::Kind;
  Json given = Json::object();
  for (const auto& option : options) {
    const auto column = table.find(option.name);
    if (column < 0) continue;
    const auto at = static_cast<std::size_t>(column);
    if (option.kind == Kind::text) {
      const std::string cell(signal::trim_blanks(row.cells[at]));
      if (!cell.empty()) given[option.name] = cell;
    } else if (const double x = table.number(row, at); std::isfinite(x)) {
      const bool whole = option.kind == Kind::integer && x == std::round(x) && std::abs(x) < 1e9;
      given[option.name] = whole ? Json(std::lround(x)) : Json(x);
    }
  }
  if (const auto misfit = describe::fill(options, given)) {
    throw model::SceneError({table.file, row.line, 0, misfit->name}, misfit->problem,
                            "correct the cell (blank where the value is optional)");
  }
}

TextTable read_text_table(const std::filesystem::path& path) {
  const signal::MappedFile mapped(path);
  signal::refuse_foreign(mapped.bytes(), path);
  TextTable table;
  table.file = path.string();
  const auto error = [&](long line, const std::string& problem, const char* remedy) {
    return model::SceneError({table.file, line, 0, ""}, problem, remedy);
  };
  constexpr const char* kRemedy = "give a header line and rows of numbers";
  const auto lines = lines_of(signal::text_without_mark(mapped.bytes(), table.file));
  for (const auto& line : lines) {
    for (const auto& cell : line.cells) {
      if (!is_number(cell, '.') && is_number(cell, ',')) table.decimal = ',';
    }
  }
  // Names are in the first of the longest lines, if it holds no number; else in that above the
  // first number.
  const auto has_number = [&](const TextTable::Row& line) {
    return std::ranges::any_of(line.cells,
                               [&](const auto& cell) { return is_number(cell, table.decimal); });
  };
  auto header =
      std::ranges::max_element(lines, {}, [](const auto& line) { return line.cells.size(); });
  const auto first = std::ranges::find_if(lines, has_number);
  if (lines.size() < 2 || first == lines.end()) throw error(0, "holds no rows", kRemedy);
  if (has_number(*header)) {
    if (first == lines.begin())
      throw error(first->line, "names no columns above its numbers", kRemedy);
    header = first - 1;
  }
  table.header_line = header->line;
  for (const auto& cell : header->cells) {
    table.columns.push_back(column_of(signal::split_title(cell)));
  }
  auto body = header + 1;
  // Units may stand in a line of their own.
  const bool units = body != lines.end() && std::ranges::all_of(body->cells, [](const auto& cell) {
                       return cell.empty() || signal::parse_unit(cell).has_value();
                     });
  if (units && !has_number(*body)) {
    for (std::size_t c = 0; c < std::min(body->cells.size(), table.columns.size()); ++c) {
      table.columns[c] = column_of({table.columns[c].name, body->cells[c]});
    }
    ++body;
  }
  for (; body != lines.end(); ++body) {
    const std::size_t count = body->cells.size();
    if (count > table.columns.size()) {
      throw error(body->line,
                  fmt::format("has {} values, the header {}", count, table.columns.size()),
                  "give every row a value or a blank for each column");
    }
    table.rows.push_back(*body);
    table.rows.back().cells.resize(table.columns.size());
  }
  return table;
}

}  // namespace rigfit::apps
