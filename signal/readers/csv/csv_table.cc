#include "signal/readers/csv/csv_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <utility>

#include "signal/numerics/numbers.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/recording_time.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

constexpr std::size_t kStride = std::size_t{1} << 24;  // bytes between calls of `progress`
constexpr std::size_t kLongestFooter = 1 << 16;

/// A field that makes a line no row of the table.
struct BadField {
  std::string_view text;
  std::size_t column = 0;
  const char* problem = "";
  const char* remedy = "";
  bool is_word = false;  ///< text, as in a line behind the table
};

/// Rows to make room for: of a long table by its beginning, so that its pages are looked at once.
long likely_rows(std::string_view body) {
  constexpr std::size_t kHead = std::size_t{1} << 20;
  const auto head = body.substr(0, kHead);
  const auto lf = std::count(head.begin(), head.end(), '\n');
  const long rows = (lf > 0 ? lf : std::count(head.begin(), head.end(), '\r')) + 1;
  if (body.size() <= kHead) return rows;
  return static_cast<long>(1.02 * static_cast<double>(rows) * static_cast<double>(body.size()) /
                           static_cast<double>(kHead));
}

class BodyParser {
 public:
  BodyParser(std::string_view bytes, const CsvLayout& layout, const std::vector<bool>& wanted,
             const std::string& file)
      : bytes_(bytes), layout_(layout), wanted_(wanted), file_(file) {
    // Every field but the last of a line costs at least its separator.
    const std::size_t size = bytes.size() - layout.body;
    const auto stored = std::count(wanted.begin(), wanted.end(), true);
    most_rows_ = static_cast<long>(2 * size + 4096) / std::max<long>(stored, 1);
    body_.columns.resize(layout.columns.size());
    target_.resize(layout.columns.size(), nullptr);
    const long rows = likely_rows(bytes.substr(layout.body));
    if (rows > most_rows_) throw ragged();
    reserve(rows);
  }

  CsvBody parse(const std::function<void(std::size_t)>& progress) {
    std::size_t told = layout_.body;
    for (std::string_view rest = bytes_.substr(layout_.body); !rest.empty();) {
      const std::size_t at = bytes_.size() - rest.size();
      const std::string_view line = take_line(rest);
      const bool has_end = at + line.size() < bytes_.size();
      const Eigen::Index rows = body_.rows;
      const long short_rows = body_.short_rows;
      try {
        parse_line(line);
        body_.incomplete_last = !has_end && body_.short_rows > short_rows && rows > 0;
      } catch (const BadField& bad) {
        body_.incomplete_last = !has_end && rows > 0;
        if (has_end && ends_table(at, bad)) break;
        if (!body_.incomplete_last) throw refusal(bad);
      }
      // A logger that lost its power: the line is not whole.
      if (body_.incomplete_last) body_.rows = rows, body_.short_rows = short_rows;
      if (progress && at - told > kStride) {
        progress(at);
        told = at;
      }
    }
    trim();
    return std::move(body_);
  }

 private:
  void reserve(Eigen::Index rows) {
    if (capacity_ == most_rows_) throw ragged();
    capacity_ = std::min<Eigen::Index>(rows, most_rows_);
    for (std::size_t c = 0; c < target_.size(); ++c) {
      if (!wanted_[c]) continue;
      body_.columns[c].conservativeResize(capacity_);
      target_[c] = body_.columns[c].data();
    }
  }

  /// Throws BadField.
  void parse_line(std::string_view line) {
    const bool by_tabs = layout_.dialect.separator == '\t';
    const std::size_t first = line.find_first_not_of(by_tabs ? " " : " \t");
    if (first == std::string_view::npos) return;
    if (line[first] == '#' || line[first] == '%') {
      ++body_.comment_lines;
      return;
    }
    if (body_.rows == capacity_) reserve(capacity_ + capacity_ / 2 + 16);
    split_fields(line, layout_.dialect, fields_);
    for (std::size_t c = 0; c < fields_.size(); ++c) {
      const std::string_view text = fields_[c].text;
      if (c >= target_.size() && !text.empty()) {
        throw BadField{text, c, "more fields than the table has columns",
                       "check for decimal commas, or for a separator inside a field"};
      }
      if (c < target_.size() && target_[c] != nullptr) target_[c][body_.rows] = value_of(text, c);
    }
    // What is not there is missing.
    bool lacking = false;
    for (std::size_t c = fields_.size(); c < target_.size(); ++c) {
      if (target_[c] == nullptr) continue;
      target_[c][body_.rows] = kNaN;
      lacking = true;
    }
    body_.short_rows += lacking ? 1 : 0;
    ++body_.rows;
  }

  [[nodiscard]] double value_of(std::string_view text, std::size_t c) const {
    double value = 0;
    int decimals = 0;
    const ColumnKind kind = layout_.columns[c].kind;
    if (parse_whole_number(text, layout_.dialect.decimal, value)) {
      if (std::isfinite(value)) return value;
      throw BadField{text, c, "a number too large for a double", "check the value"};
    }
    if (kind == ColumnKind::clock && parse_clock(text, value, decimals)) return value;
    if (text.empty() || is_missing_word(text) || kind == ColumnKind::empty) return kNaN;
    throw BadField{text, c, "not a number",
                   "fix or delete the line, or leave the field empty where there is no value; "
                   "where a second table begins, split the file",
                   true};
  }

  /// Whether the line at `at`, with its bad field, stands behind the table.
  bool ends_table(std::size_t at, const BadField& bad) {
    const std::size_t behind = next_line(bytes_, line_end(bytes_, at));
    if (!bad.is_word || bytes_.size() - behind >= kLongestFooter || body_.rows == 0 ||
        holds_rows(behind)) {
      return false;
    }
    body_.footer_line = line_number(bytes_, at);
    return true;
  }

  /// Whether some line from `at` on looks like a row: numbers in at least half of the columns.
  [[nodiscard]] bool holds_rows(std::size_t at) const {
    const auto columns = std::count(wanted_.begin(), wanted_.end(), true);
    std::vector<CsvField> fields;
    for (std::string_view rest = bytes_.substr(at); !rest.empty();) {
      split_fields(take_line(rest), layout_.dialect, fields);
      long numbers = 0;
      for (std::size_t c = 0; c < std::min(fields.size(), wanted_.size()); ++c) {
        const FieldKind kind = kind_of(fields[c].text, layout_.dialect.decimal);
        numbers += wanted_[c] && (kind == FieldKind::number || kind == FieldKind::clock) ? 1 : 0;
      }
      if (numbers > 0 && 2 * numbers >= columns) return true;
    }
    return false;
  }

  /// Leaves out rows of nothing at the end (spreadsheets have them), and room that is not used.
  void trim() {
    const auto is_empty = [&](Eigen::Index row) {
      return std::none_of(target_.begin(), target_.end(), [&](const double* column) {
        return column != nullptr && !std::isnan(column[row]);
      });
    };
    for (; body_.rows > 0 && is_empty(body_.rows - 1); --body_.rows) ++body_.empty_rows_at_end;
    for (std::size_t c = 0; c < target_.size(); ++c) {
      if (wanted_[c]) body_.columns[c].conservativeResize(body_.rows);
    }
  }

  [[nodiscard]] RecordingError ragged() const {
    return {{file_, layout_.body_line, 0, "", ""},
            "the lines hold far fewer fields than the widest has columns (" +
                std::to_string(layout_.columns.size()) + ")",
            "give a table whose lines all have the same columns"};
  }
  [[nodiscard]] RecordingError refusal(const BadField& bad) const {
    return text_error(bytes_, file_, bad.text, bad.problem, bad.remedy,
                      bad.column < wanted_.size() ? layout_.columns[bad.column].name : "");
  }

  const std::string_view bytes_;
  const CsvLayout& layout_;
  const std::vector<bool>& wanted_;
  const std::string& file_;
  CsvBody body_;
  std::vector<double*> target_;  ///< of the columns that are wanted; null: of another
  std::vector<CsvField> fields_;
  Eigen::Index capacity_ = 0, most_rows_ = 0;
};

void note_body(const CsvBody& body, std::vector<Note>& notes) {
  const auto note = [&](long count, const char* code, const char* message) {
    if (count > 0) add_note(notes, code, "", fmt::runtime(message), count);
  };
  note(body.short_rows, "incomplete",
       "{} lines have fewer fields than the table has columns; what is absent counts as missing");
  note(body.comment_lines, "left_out", "{} comment lines inside the table skipped");
  note(body.footer_line, "left_out", "text behind the table skipped, from line {}");
  note(body.incomplete_last ? 1 : 0, "incomplete",
       "the last line broke off before its end and is left out");
  note(body.empty_rows_at_end, "left_out", "{} rows without any number at the end left out");
}

/// Joins a series that is written several values a line, as the number of them shows which the
/// header states, or their duration beside a rate ("NPTS= 4000" above lines of five).
bool join_lines(CsvTable& table, CsvBody& body) {
  CsvLayout& layout = table.layout;
  const auto width = std::ssize(body.columns);
  const auto is_short = [&](const auto& column) { return column.size() != body.rows; };
  if (layout.dialect.separator != ' ' || width < 2 || std::ranges::any_of(body.columns, is_short)) {
    return false;
  }
  Eigen::VectorXd series(width * body.rows);
  for (Eigen::Index c = 0; c < width; ++c) {
    series(Eigen::seqN(c, body.rows, width)) = body.columns[static_cast<std::size_t>(c)];
  }
  Eigen::Index size = series.size();
  while (std::isnan(series[size - 1])) --size;
  static const std::regex kNumber(R"(\d*\.?\d+)");
  const std::sregex_iterator first(layout.heading.begin(), layout.heading.end(), kNumber), end;
  const bool stated = std::any_of(first, end, [&](const std::smatch& number) {
    double value = 0;
    return parse_whole_number(number.str(), '.', value) &&
           (value == size || value * layout.stated_rate_hz == size);
  });
  if (!stated) return false;
  add_note(table.notes, "read_as", "",
           "lines of {} values are joined to one series of {}, as the header states", width, size);
  layout.unmatched_titles.clear();
  layout.has_names = false;
  layout.columns.resize(1);
  layout.columns[0].name.clear();
  layout.columns[0].unit.clear();
  body.columns = {series.head(size)};
  body.short_rows = 0;
  return true;
}

}  // namespace

CsvBody parse_csv_body(std::string_view bytes, const CsvLayout& layout,
                       const std::vector<bool>& wanted, const std::string& file,
                       const std::function<void(std::size_t)>& progress) {
  return BodyParser(bytes, layout, wanted, file).parse(progress);
}

void CsvTable::add(CsvColumn description, std::size_t place, Eigen::VectorXd numbers) {
  Channel channel;
  const std::string first =
      description.name.empty() ? "column " + std::to_string(place + 1) : description.name;
  channel.name = unused_name(first, used_);
  if (channel.name != first) {
    add_note(notes, "duplicate_name", channel.name,
             "a second column named \"{}\" is called \"{}\" here", first, channel.name);
  }
  if (description.kind == ColumnKind::clock) {
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
             "Check the unit: the numbers exceed the header's range of "
             "{:.9g}, which is not used",
             description.range);
    channel.nominal_range = 0;
  }
  if (channel.missing_samples == channel.samples.size()) {
    add_note(notes, "no_samples", channel.name, "holds no number at all");
  }
  channels.push_back(std::move(channel));
  columns.push_back(std::move(description));
  places.push_back(place);
}

CsvTable read_csv_columns(std::string_view bytes, const std::string& file,
                          const ReadOptions& options) {
  CsvTable table;
  table.file = file;
  table.layout = find_csv_layout(bytes, file, options);
  const CsvLayout& layout = table.layout;
  std::vector<bool> wanted;
  for (const CsvColumn& column : layout.columns) {
    const bool named = !column.name.empty();
    // Without a name among named ones, and mostly empty: somebody's side calculation.
    wanted.push_back(column.has_data()
                         ? named || !layout.has_names || column.filled >= 0.5
                         : named && column.kind == ColumnKind::empty && !layout.more_titles);
  }
  CsvBody body = parse_csv_body(bytes, layout, wanted, file, options.done_with);
  if (body.rows == 0) {
    throw RecordingError({file, layout.body_line, 0, "", ""}, "the table holds no numbers",
                         "check the recording");
  }
  if (join_lines(table, body)) wanted = {true};
  const std::size_t n = layout.columns.size();

  if (!layout.unmatched_titles.empty()) {
    add_note(table.notes, "titles_not_matched", "",
             "the titles \"{}\" do not part into {} columns: columns are named by their "
             "number; part the titles by tabs, or name channels in a TOML file",
             layout.unmatched_titles, n);
  }
  std::vector<std::size_t> unnamed;
  for (std::size_t c = 0; c < n; ++c) {
    if (wanted[c]) continue;
    const CsvColumn& column = layout.columns[c];
    if (!column.unread.empty()) {
      add_note(table.notes, "data_left_out", column.name,
               "column {} is left out: \"{}\" is no number; rewrite or part it if it holds data",
               c + 1, column.unread);
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
  note_body(body, table.notes);
  for (std::size_t c = 0; c < n; ++c) {
    if (wanted[c]) table.add(layout.columns[c], c, std::move(body.columns[c]));
  }
  return table;
}

}  // namespace rigfit::signal
