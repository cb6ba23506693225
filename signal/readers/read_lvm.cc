#include "signal/readers/files/read_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "signal/numerics/numbers.h"
#include "signal/readers/csv/csv_fields.h"
#include "signal/readers/csv/csv_layout.h"
#include "signal/readers/csv/csv_table.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/recording_time.h"
#include "signal/recording/time_axis.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

constexpr std::string_view kEndOfHeader = "***End_of_Header***";

/// A header and its table; the file's own header has none.
struct Segment {
  std::map<std::string, std::vector<std::string>> header;  ///< by key; field k at [k - 1]
  CsvLayout layout;
  CsvBody body;
  std::vector<std::size_t> value_columns, x_columns;

  [[nodiscard]] std::string text(const std::string& key, std::size_t column) const {
    const auto row = header.find(key);
    return row == header.end() || column == 0 || column > row->second.size()
               ? std::string()
               : row->second[column - 1];
  }
  /// NaN where there is none.
  [[nodiscard]] double number(const std::string& key, std::size_t column) const {
    double value = 0;
    const std::string own = text(key, column);
    return parse_whole_number(own, '.', value) || parse_whole_number(own, ',', value) ? value
                                                                                      : kNaN;
  }
  [[nodiscard]] double start(std::size_t column) const {
    const double x0 = number("X0", column);
    return std::isfinite(x0) ? x0 : 0;
  }
  /// Seconds of its Date and Time; NaN when it has none.
  [[nodiscard]] double clock(std::size_t column) const {
    double seconds = 0;
    int decimals = 0;
    return parse_clock(text("Date", column) + " " + text("Time", column), seconds, decimals)
               ? seconds
               : kNaN;
  }
  /// Delta_X as a rate, uncertain by its last printed digit.
  [[nodiscard]] RateOfStep rate(std::size_t column) const {
    const std::string own = text("Delta_X", column);
    const int decimals = std::max(printed_decimals(own, '.'), printed_decimals(own, ','));
    return rate_of_step(number("Delta_X", column), 0.5 * std::pow(10.0, -decimals));
  }
  [[nodiscard]] bool has_numbers(std::size_t column) const {
    return !body.columns[column].array().isNaN().all();
  }
  [[nodiscard]] bool has_channels_of(const Segment& other) const {
    return std::ranges::equal(layout.columns, other.layout.columns,
                              [](const CsvColumn& a, const CsvColumn& b) {
                                return a.name == b.name && a.unit == b.unit;
                              });
  }
  /// The column of X values in front of a channel, or the only one; empty: there is none.
  [[nodiscard]] Eigen::VectorXd x_of(std::size_t channel, int& decimals) const {
    const auto at = std::find_if(x_columns.rbegin(), x_columns.rend(),
                                 [&](std::size_t c) { return c <= channel && has_numbers(c); });
    if (at == x_columns.rend()) return {};
    decimals = layout.columns[*at].decimals;
    return body.columns[*at];
  }
};

class LvmReader {
 public:
  LvmReader(std::string_view bytes, const std::string& file, const ReadOptions& options)
      : bytes_(bytes), file_(file), done_with_(options.done_with) {
    rest_ = bytes_.substr(bytes_.starts_with("\xEF\xBB\xBF") ? 3 : 0);
  }

  std::vector<Segment> read() {
    Segment file;
    read_header(file);
    if (file.text("Separator", 1) == "Comma") dialect_.separator = ',';
    const std::string decimal = file.text("Decimal_Separator", 1);
    if (decimal == ",") dialect_.decimal = ',';
    decimal_known_ = !decimal.empty();
    std::vector<Segment> segments;
    while (skip_blank_lines()) {
      segments.push_back(read_segment());
      if (!segments.back().has_channels_of(segments.front())) {
        throw error(segments.back().layout.body_line,
                    fmt::format("segment {} has other channels than the first", segments.size()),
                    "split the file into one for each kind of segment");
      }
    }
    if (segments.empty()) throw error(line(), "holds a header but no measurement", "record again");
    return segments;
  }

 private:
  /// Number of the next line.
  [[nodiscard]] long line() const {
    return line_number(bytes_, std::min(bytes_.size() - rest_.size(), bytes_.size() - 1));
  }
  [[nodiscard]] RecordingError error(long line, std::string problem, std::string remedy) const {
    return {{file_, line, 0, "", ""}, std::move(problem), std::move(remedy)};
  }

  /// Whether a line follows that is not blank.
  bool skip_blank_lines() {
    for (auto after = rest_; !after.empty(); rest_ = after) {
      if (!trim_blanks(take_line(after)).empty()) return true;
    }
    return false;
  }

  void read_header(Segment& segment) {
    std::vector<CsvField> fields;
    const long first = line();
    while (!rest_.empty()) {
      const auto text = take_line(rest_);
      if (text.starts_with(kEndOfHeader)) return;
      if (trim_blanks(text).empty()) continue;
      // Before the separator is known a tab or a comma behind the key may be it.
      const bool by_tabs = text.find('\t') != std::string_view::npos;
      split_fields(text, {by_tabs ? dialect_.separator : ',', '.'}, fields);
      const std::string key = to_utf8(fields[0].text);
      std::vector<std::string> row;
      for (std::size_t k = 1; k < fields.size(); ++k) row.push_back(to_utf8(fields[k].text));
      // "Decimal_Separator,," with a comma as separator reads as empty fields.
      if (key == "Decimal_Separator" && !by_tabs) {
        row.assign(1, text.substr(key.size()).starts_with(",,") ? "," : ".");
      }
      segment.header.emplace(key, std::move(row));
    }
    throw error(first, "a header without its end",
                "a header ends with a line \"" + std::string(kEndOfHeader) + "\"");
  }

  Segment read_segment() {
    Segment segment;
    read_header(segment);
    skip_blank_lines();
    const long titles_line = line();
    std::vector<CsvField> titles;
    split_fields(take_line(rest_), dialect_, titles);
    if (titles.size() < 2 || (titles[0].text != "X_Value" && titles[0].text != "X")) {
      throw error(titles_line, "the titles of a table, X_Value first, are missing",
                  "keep the titles that LabVIEW writes");
    }
    const std::size_t begin = bytes_.size() - rest_.size();
    for (auto after = rest_; !after.empty(); rest_ = after) {
      if (trim_blanks(take_line(after)).empty()) break;
    }
    const std::size_t end = bytes_.size() - rest_.size();
    if (!decimal_known_ && dialect_.separator != ',') {
      // The sign that the numbers carry, where the file does not say.
      const auto head = bytes_.substr(begin, std::min<std::size_t>(end - begin, 1 << 16));
      const bool comma = std::ranges::count(head, ',') > std::ranges::count(head, '.');
      dialect_.decimal = comma ? ',' : '.';
    }
    CsvLayout& layout = segment.layout;
    layout.dialect = dialect_;
    layout.body = begin;
    layout.body_line = titles_line + 1;
    layout.has_names = true;
    std::vector<bool> wanted;
    for (std::size_t c = 0; c < titles.size(); ++c) {
      const auto title = titles[c].text;
      CsvColumn column;
      column.name = to_utf8(title);
      wanted.push_back(c + 1 < titles.size() || (title != "Comment" && !title.empty()));
      if (title == "X_Value" || (c == 0 && title == "X")) {
        segment.x_columns.push_back(c);
      } else if (wanted[c]) {
        segment.value_columns.push_back(c);
        column.unit = segment.text("Y_Unit_Label", c);
      }
      layout.columns.push_back(std::move(column));
    }
    if (begin < end && !segment.value_columns.empty()) {
      const auto text = bytes_.substr(0, end);
      find_csv_decimals(text, layout);
      segment.body = parse_csv_body(text, layout, wanted, file_, done_with_);
    }
    if (segment.body.rows == 0) {
      throw error(begin < end ? layout.body_line : titles_line, "the table holds no numbers",
                  "record again");
    }
    return segment;
  }

  std::string_view bytes_, rest_;
  const std::string& file_;
  const std::function<void(std::size_t)>& done_with_;
  CsvDialect dialect_{'\t', '.'};
  bool decimal_known_ = false;
};

/// Times of every segment on one axis, and the digits that they are printed with.
Eigen::VectorXd joined_times(const std::vector<Segment>& segments, std::size_t reference,
                             int& decimals) {
  Eigen::VectorXd time;
  const Segment& first = segments.front();
  int digits = 400;
  bool all_have_x = true;
  for (const auto& segment : segments) {
    const Eigen::Index n = segment.body.rows, row = time.size();
    const double rate = segment.rate(reference).rate_hz, step = rate > 0 ? 1 / rate : 0;
    Eigen::VectorXd x = segment.x_of(reference, row == 0 ? decimals : digits);
    if (x.size() == 0) {
      all_have_x = false;
      x = segment.start(reference) +
          step * Eigen::ArrayXd::LinSpaced(n, 0, static_cast<double>(n - 1));
    }
    if (row > 0) {
      // X may run on or begin anew; then clocks that resolve the segments tell where it belongs.
      const double next = time[row - 1] + step;
      const double by_clock =
          segment.clock(reference) - first.clock(reference) + first.start(reference);
      const double start = x[0] > time[row - 1] ? x[0] : by_clock > time[row - 1] ? by_clock : next;
      x.array() += (std::abs(start - next) < 0.5 * step ? next : start) - x[0];
    }
    time.conservativeResize(row + n);
    time.tail(n) = x;
  }
  if (!all_have_x) decimals = 400;
  return time;
}

/// A channel's numbers in all segments; the header's number of them is compared with the table's.
void take_channel(const std::vector<Segment>& segments, std::size_t c, std::size_t reference,
                  CsvTable& table) {
  const Segment& first = segments.front();
  const double delta = first.number("Delta_X", c), usual = first.number("Delta_X", reference);
  if (first.has_numbers(c) && delta > 0 && usual > 0 && std::abs(delta / usual - 1) > 1e-6) {
    add_note(table.notes, "data_left_out", first.layout.columns[c].name,
             "is sampled at another rate than \"{}\" (Delta_X {} s): left out",
             first.layout.columns[reference].name, first.text("Delta_X", c));
    return;
  }
  Eigen::VectorXd numbers;
  double stated = 0;
  for (const auto& segment : segments) {
    numbers.conservativeResize(numbers.size() + segment.body.rows);
    numbers.tail(segment.body.rows) = segment.body.columns[c];
    const double samples = segment.number("Samples", c);
    if (std::isfinite(samples)) stated += samples;
  }
  table.add(first.layout.columns[c], c, std::move(numbers));
  const Channel& channel = table.channels.back();
  const auto held = static_cast<double>(channel.samples.size() - channel.missing_samples);
  if (held > 0 && stated > 0 && stated != held) {
    add_note(table.notes, "read_as", channel.name,
             "the header states {:.0f} samples, the table holds {:.0f}", std::min(stated, 1e15),
             held);
  }
}

}  // namespace

Recording read_lvm(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options) {
  const std::string file = path.string();
  const std::vector<Segment> segments = LvmReader(bytes, file, options).read();
  const Segment& first = segments.front();
  const std::string dimension = first.text("X_Dimension", 1);
  if (!dimension.empty() && dimension != "Time") {
    throw RecordingError({file, line_number(bytes, bytes.find("X_Dimension")), 0, "", dimension},
                         "is no recording over time", "give a file whose X_Dimension is Time");
  }
  const auto filled = std::ranges::find_if(first.value_columns,
                                           [&](std::size_t c) { return first.has_numbers(c); });
  const std::size_t reference =
      filled == first.value_columns.end() ? first.value_columns.front() : *filled;
  const std::string delta = first.text("Delta_X", reference);
  const RateOfStep stated = first.rate(reference);

  CsvTable table;
  table.file = file;
  table.layout = first.layout;
  table.layout.stated_rate_hz = stated.rate_hz;
  table.layout.rate_text = "Delta_X = " + delta;
  if (segments.back().body.incomplete_last) {
    add_note(table.notes, "incomplete", "",
             "the last line broke off before its end and is left out");
  }
  if (segments.size() > 1) {
    table.layout.body_line = 0;
    add_note(table.notes, "read_as", "", "{} segments are joined into one recording",
             segments.size());
  }
  CsvColumn x;
  x.name = "X_Value";
  x.unit = "s";
  const bool has_times = segments.size() > 1 || first.x_of(reference, x.decimals).size() > 0;
  if (has_times) {
    Eigen::VectorXd times = joined_times(segments, reference, x.decimals);
    table.add(x, 0, std::move(times));
  }
  for (const std::size_t c : first.value_columns) take_channel(segments, c, reference, table);
  Recording recording = recording_of_table(std::move(table), path, "lvm", options);
  if (has_times) return recording;
  recording.start_time_s = first.start(reference);
  if (options.sample_rate_hz > 0) return recording;
  recording.sample_rate_relative_std = stated.relative_std;
  // 20 ppm: what ordinary loggers' clocks are off by anyhow.
  if (stated.relative_std > 2e-5) {
    add_note(recording.notes, "read_as", "",
             "Give sample_rate_hz if it is known better: Delta_X is printed as {}, so "
             "{:.9g} Hz is uncertain by {:.2g} Hz, and every frequency in proportion",
             delta, stated.rate_hz, stated.relative_std * stated.rate_hz);
  }
  return recording;
}

}  // namespace rigfit::signal
