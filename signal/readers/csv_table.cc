#include "signal/readers/csv_table.h"

#include <fmt/ranges.h>

#include <regex>

#include "signal/recording/recording_time.h"

namespace rigfit::signal {
namespace {

constexpr std::size_t kStride = std::size_t{1} << 24;  // bytes between calls of `progress`

/// A field that makes a line no row of the table.
struct BadField {
  std::string_view text;
  std::size_t column = 0;
  const char* problem = "";
  const char* remedy = "";
  bool is_word = false;  ///< text, as in a line behind the table
};

class BodyParser {
 public:
  BodyParser(std::string_view bytes, CsvTable& table)
      : bytes_(bytes), table_(table), layout_(table.layout), columns_(layout_.columns.size()) {
    const auto body = bytes.substr(layout_.body);
    // Room for all lines. Every field but the last of a line costs at least its separator.
    const auto lines = std::ranges::count(body, '\n') + std::ranges::count(body, '\r') + 1;
    const auto stored = std::ranges::count(layout_.columns, true, &CsvColumn::wanted);
    if (lines * stored > 2 * std::ssize(body) + 4096) {
      throw RecordingError(
          {table.file, layout_.body_line},
          fmt::format("the lines hold far fewer fields than the widest has columns ({})",
                      columns_.size()),
          "give a table whose lines all have the same columns");
    }
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      if (layout_.columns[c].wanted) columns_[c].resize(lines);
    }
  }

  std::vector<VectorXd> parse(const std::function<void(std::size_t)>& progress) {
    std::size_t told = layout_.body;
    for (std::string_view rest = bytes_.substr(layout_.body); !rest.empty();) {
      const std::size_t at = bytes_.size() - rest.size();
      const std::string_view line = take_line(rest);
      // A logger that lost its power: the line is not whole.
      const bool may_break = at + line.size() == bytes_.size() && rows_ > 0;
      try {
        incomplete_last_ = !parse_line(line, may_break);
      } catch (const BadField& bad) {
        incomplete_last_ = may_break;
        if (!may_break && ends_table(at, bad)) break;
        if (!may_break) throw refusal(bad);
      }
      if (progress && at - told > kStride) {
        progress(at);
        told = at;
      }
    }
    trim();
    return std::move(columns_);
  }

 private:
  /// False: fields are absent, and are to be taken for a sign that the line is not whole. Throws
  /// BadField.
  bool parse_line(std::string_view line, bool may_break) {
    const bool by_tabs = layout_.dialect.separator == '\t';
    const std::size_t first = line.find_first_not_of(by_tabs ? " " : " \t");
    if (first == std::string_view::npos) return true;
    if (line[first] == '#' || line[first] == '%') return ++comment_lines_ > 0;
    split_fields(line, layout_.dialect, fields_);
    for (std::size_t c = 0; c < fields_.size(); ++c) {
      const std::string_view text = fields_[c].text;
      if (c >= columns_.size() && !text.empty()) {
        throw BadField{text, c, "more fields than the table has columns",
                       "check for decimal commas, or for a separator inside a field"};
      }
      if (c < columns_.size() && layout_.columns[c].wanted) columns_[c][rows_] = value_of(text, c);
    }
    // What is not there is missing. Between blanks nobody can say which it is, but in the last
    // line.
    if (short_) throw refusal(*short_);
    if (fields_.size() < columns_.size() && layout_.dialect.separator == ' ') {
      short_ = {line, fields_.size(), "fewer fields than the table has columns",
                "write \"nan\" where nothing was measured, or put commas between columns"};
    }
    bool lacking = false;
    for (std::size_t c = fields_.size(); c < columns_.size(); ++c) {
      if (!layout_.columns[c].wanted) continue;
      columns_[c][rows_] = kNaN;
      lacking = true;
    }
    if (lacking && may_break) return false;
    short_rows_ += lacking ? 1 : 0;
    return ++rows_ > 0;
  }

  [[nodiscard]] double value_of(std::string_view text, std::size_t c) const {
    double value = 0;
    int decimals = 0;
    const FieldKind kind = layout_.columns[c].kind;
    if (parse_whole_number(text, layout_.dialect.decimal, value)) {
      if (std::isfinite(value)) return value;
      throw BadField{text, c, "a number too large for a double", "check the value"};
    }
    if (kind == FieldKind::clock && parse_clock(text, value, decimals)) return value;
    if (text.empty() || is_missing_word(text) || kind == FieldKind::empty) return kNaN;
    throw BadField{text, c, "not a number",
                   "fix or delete the line, or leave the field empty where there is no value; "
                   "where a second table begins, split the file",
                   true};
  }

  /// Whether the line at `at`, with its bad field, stands behind the table.
  bool ends_table(std::size_t at, const BadField& bad) {
    if (!bad.is_word || rows_ == 0 || holds_rows(at)) return false;
    footer_line_ = line_number(bytes_, at);
    return true;
  }

  /// Whether some line from `at` on looks like a row: it begins as a number, with any sign behind
  /// the first digits, or lines behind the first one have numbers in at least half of the columns.
  [[nodiscard]] bool holds_rows(std::size_t at) const {
    const auto columns = std::ranges::count(layout_.columns, true, &CsvColumn::wanted);
    std::string_view rest = bytes_.substr(at);
    for (bool first = true; !rest.empty(); first = false) {
      const auto line = take_line(rest);
      double value = 0;
      if (parse_number(trim_blanks(line), '.', value) > 0) return true;
      if (first) continue;
      const CsvRow row(line, layout_.dialect);
      const auto numbers = std::ranges::count_if(layout_.columns, [&](const CsvColumn& column) {
        const FieldKind kind = row.kind(column.place);
        return column.wanted && (kind == FieldKind::number || kind == FieldKind::clock);
      });
      if (numbers > 0 && 2 * numbers >= columns) return true;
    }
    return false;
  }

  /// Leaves out rows of nothing at the end (spreadsheets have them) and room that is not used, and
  /// notes what is not read.
  void trim() {
    const auto is_empty = [&](Index row) {
      return std::ranges::none_of(columns_, [&](const VectorXd& column) {
        return column.size() > 0 && !std::isnan(column[row]);
      });
    };
    const Index all = rows_;
    while (rows_ > 0 && is_empty(rows_ - 1)) --rows_;
    if (rows_ == 0) {
      throw RecordingError({table_.file, layout_.body_line}, "the table holds no numbers",
                           "check the recording, or record again");
    }
    for (auto& column : columns_) {
      if (column.size() > 0) column.conservativeResize(rows_);
    }
    const auto note = [&](long count, const char* code, const char* message) {
      if (count > 0) add_note(table_.notes, code, "", fmt::runtime(message), count);
    };
    note(short_rows_, "incomplete",
         "{} lines have fewer fields than the table has columns; what is absent counts as missing");
    note(comment_lines_, "left_out", "{} comment lines inside the table skipped");
    note(footer_line_, "left_out", "text behind the table skipped, from line {}");
    note(incomplete_last_ ? 1 : 0, "incomplete",
         "the last line broke off before its end and is left out");
    note(all - rows_, "left_out", "{} rows without any number at the end left out");
  }

  [[nodiscard]] RecordingError refusal(const BadField& bad) const {
    return text_error(bytes_, table_.file, bad.text, bad.problem, bad.remedy,
                      bad.column < columns_.size() ? layout_.columns[bad.column].name : "");
  }

  const std::string_view bytes_;
  CsvTable& table_;
  const CsvLayout& layout_;
  std::vector<VectorXd> columns_;  ///< those that are not wanted are empty
  std::vector<CsvField> fields_;
  Index rows_ = 0;
  std::optional<BadField> short_;                              ///< the line before, between blanks
  long short_rows_ = 0, comment_lines_ = 0, footer_line_ = 0;  ///< rows and lines; line or 0
  bool incomplete_last_ = false;
};

/// Refuses "1,023", "1|5" or "0;3" in a column of texts: numbers with another decimal sign, whole
/// ones with their thousands parted, or lines parted by another sign.
void refuse_other_writing(std::string_view bytes, const std::string& file, const CsvColumn& column,
                          char decimal) {
  double value = 0;
  const auto rest = column.unread.substr(parse_number(column.unread, decimal, value));
  const std::string_view signs = ",.;|'\t ";
  if (rest.size() == column.unread.size() || rest.size() < 2 || signs.find(rest[0]) == signs.npos ||
      rest[1] < '0' || rest[1] > '9') {
    return;
  }
  throw text_error(bytes, file, column.unread,
                   "may be a number with another decimal sign, with its thousands parted, or two",
                   "write numbers without signs between thousands and with one decimal sign, or "
                   "say what separates columns: --separator, --decimal",
                   column.name);
}

/// Refuses a series that is written several values a line, as the number of them shows which the
/// header states, or their duration beside a rate ("NPTS= 4000" above lines of five).
void refuse_series(const CsvTable& table, const std::vector<VectorXd>& columns) {
  const auto width = std::ssize(columns);
  const Index rows = columns.front().size();
  const auto is_other = [&](const auto& column) { return column.size() != rows; };
  if (table.layout.dialect.separator != ' ' || width < 2 || rows == 0 ||
      std::ranges::any_of(columns, is_other)) {
    return;
  }
  const auto absent = std::ranges::count_if(
      columns, [&](const auto& column) { return std::isnan(column[rows - 1]); });
  const auto size = static_cast<double>(width * rows - absent);
  static const std::regex kNumber(R"(\d*\.?\d+)");
  const std::string& heading = table.layout.heading;
  for (std::sregex_iterator one(heading.begin(), heading.end(), kNumber), end; one != end; ++one) {
    double value = 0;
    if (!parse_whole_number(one->str(), '.', value)) continue;
    if (value != size && value * table.layout.stated_rate_hz != size) continue;
    throw RecordingError(
        {table.file, table.layout.body_line, 0, "", one->str()},
        fmt::format("lines of {} values seem to be one series of {}, as the header states", width,
                    size),
        "write one value a line");
  }
}

}  // namespace

std::vector<VectorXd> parse_csv_body(std::string_view bytes, CsvTable& table,
                                     const std::function<void(std::size_t)>& progress) {
  return BodyParser(bytes, table).parse(progress);
}

void CsvTable::add(CsvColumn description, VectorXd numbers) {
  Channel channel;
  const std::string first = description.name.empty()
                                ? "column " + std::to_string(description.place + 1)
                                : description.name;
  channel.name = unused_name(first, used_);
  if (channel.name != first) {
    add_note(notes, "duplicate_name", channel.name,
             "a second column named \"{}\" is called \"{}\" here", first, channel.name);
  }
  if (description.kind == FieldKind::clock) {
    channel.source_unit = description.unit;
    channel.unit = "s";
    channel.quantity = Quantity::time;
  } else {
    take_unit(description.unit, channel, notes);
  }
  channel.nominal_range = description.range * channel.si_per_source;
  take_samples(std::move(numbers), channel);
  if (channel.nominal_range > 0 &&
      (channel.samples.array().abs() > 1.1 * channel.nominal_range).any()) {
    add_note(notes, "left_out", channel.name,
             "Check the unit: the numbers exceed the header's range of {:.9g}, which is not used",
             description.range);
    channel.nominal_range = 0;
  }
  if (channel.missing_samples == channel.samples.size()) {
    add_note(notes, "no_samples", channel.name, "holds no number at all");
  }
  channels.push_back(std::move(channel));
  columns.push_back(std::move(description));
}

CsvTable read_csv_columns(std::string_view bytes, const std::string& file,
                          const ReadOptions& options) {
  bytes = text_without_mark(bytes, file);
  CsvTable table;
  table.file = file;
  table.layout = find_csv_layout(bytes, file, options);
  const CsvLayout& layout = table.layout;
  for (CsvColumn& column : table.layout.columns) {
    const bool named = !column.name.empty();
    // Without a name among named ones, and mostly empty: somebody's side calculation.
    column.wanted = column.has_data()
                        ? named || !layout.has_names || column.filled >= 0.5
                        : named && column.kind == FieldKind::empty && !layout.more_titles;
  }
  auto columns = parse_csv_body(bytes, table, options.done_with);
  const std::vector<Note> of_body = std::exchange(table.notes, {});
  refuse_series(table, columns);
  const std::size_t n = layout.columns.size();

  if (layout.numbers_above > 0 && layout.rate_line < layout.body_line - layout.numbers_above) {
    add_note(
        table.notes, "data_left_out", "",
        "left out: {} lines of numbers above line {} do not have the table's columns; complete "
        "them if they are part of it",
        layout.numbers_above, layout.body_line);
  }
  if (!layout.unmatched_titles.empty()) {
    add_note(table.notes, "titles_not_matched", "",
             "the titles \"{}\" do not part into {} columns: columns are named by their number; "
             "part the titles by tabs, or name channels in a TOML file",
             layout.unmatched_titles, n);
  }
  std::vector<std::size_t> unnamed;
  for (std::size_t c = 0; c < n; ++c) {
    const CsvColumn& column = layout.columns[c];
    if (column.wanted) continue;
    if (!column.unread.empty()) {
      refuse_other_writing(bytes, file, column, layout.dialect.decimal);
      const auto at = static_cast<std::size_t>(column.unread.data() - bytes.data());
      add_note(table.notes, "data_left_out", column.name,
               "column {} is left out: \"{}\"{} is no number; rewrite or part it if it holds data",
               c + 1, to_utf8(column.unread),
               table.notes.size() < kMostListed ? fmt::format(" (line {})", line_number(bytes, at))
                                                : "");
    } else if (column.name.empty()) {
      unnamed.push_back(c + 1);
    } else {
      add_note(table.notes, "left_out", column.name, "left out: words in column {}", c + 1);
    }
  }
  if (!unnamed.empty()) {
    add_note(table.notes, "left_out", "",
             "left out, without a title and with few numbers: column {}", fmt::join(unnamed, ", "));
  }
  table.notes.insert(table.notes.end(), of_body.begin(), of_body.end());
  for (std::size_t c = 0; c < n; ++c) {
    if (layout.columns[c].wanted) table.add(layout.columns[c], std::move(columns[c]));
  }
  return table;
}

}  // namespace rigfit::signal
