#include "signal/readers/files/read_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
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

struct Header {
  std::map<std::string, std::vector<std::string>> rows;  ///< by key; field k at [k - 1]

  [[nodiscard]] std::string at(const std::string& key, std::size_t column) const {
    const auto row = rows.find(key);
    return row == rows.end() || column == 0 || column > row->second.size()
               ? std::string()
               : row->second[column - 1];
  }
  /// NaN where there is none.
  [[nodiscard]] double number(const std::string& key, std::size_t column) const {
    double value = 0;
    const std::string text = at(key, column);
    return parse_whole_number(text, '.', value) || parse_whole_number(text, ',', value) ? value
                                                                                        : kNaN;
  }
  /// Seconds of a segment's Date and Time; NaN when it has none.
  [[nodiscard]] double clock(std::size_t column) const {
    double seconds = 0;
    int decimals = 0;
    return parse_clock(at("Date", column) + " " + at("Time", column), seconds, decimals) ? seconds
                                                                                         : kNaN;
  }
};

struct Segment {
  Header header;
  CsvLayout layout;
  CsvBody body;
  std::vector<std::size_t> value_columns, x_columns;

  [[nodiscard]] bool has_numbers(std::size_t column) const {
    return !body.columns[column].array().isNaN().all();
  }
  [[nodiscard]] bool has_channels_of(const Segment& other) const {
    return std::equal(layout.columns.begin(), layout.columns.end(), other.layout.columns.begin(),
                      other.layout.columns.end(), [](const CsvColumn& a, const CsvColumn& b) {
                        return a.name == b.name && a.unit == b.unit;
                      });
  }
  /// The column of X values in front of a channel, or the only one; 0 rows: there is none.
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
  LvmReader(std::string_view bytes, const std::string& file,
            const std::function<void(std::size_t)>& done_with)
      : bytes_(bytes), file_(file), done_with_(done_with) {
    rest_ = bytes_.substr(bytes_.starts_with("\xEF\xBB\xBF") ? 3 : 0);
  }

  std::vector<Segment> read() {
    const Header header = read_header();
    const std::string separator = header.at("Separator", 1);
    if (separator == "Comma") {
      dialect_.separator = ',';
    } else if (!separator.empty() && separator != "Tab") {
      throw error(line_number(bytes_, bytes_.find("\nSeparator") + 1), separator,
                  "unknown separator", "LVM knows Tab and Comma");
    }
    const std::string decimal = header.at("Decimal_Separator", 1);
    if (decimal == "," || decimal == ".") dialect_.decimal = decimal[0];
    decimal_known_ = !decimal.empty();
    std::vector<Segment> segments;
    while (skip_blank_lines()) segments.push_back(read_segment());
    if (segments.empty()) {
      throw error(line(), "", "holds a header but no measurement",
                  "record again; a segment has its own header and a table");
    }
    return segments;
  }

 private:
  /// Number of the next line.
  [[nodiscard]] long line() const {
    return line_number(bytes_, std::min(bytes_.size() - rest_.size(), bytes_.size() - 1));
  }
  RecordingError error(long line, const std::string& value, std::string problem,
                       std::string remedy) const {
    return {{file_, line, 0, "", value}, std::move(problem), std::move(remedy)};
  }

  /// Whether a line follows that is not blank.
  bool skip_blank_lines() {
    for (auto after = rest_; !after.empty(); rest_ = after) {
      if (!trim_blanks(take_line(after)).empty()) return true;
    }
    return false;
  }

  Header read_header() {
    Header header;
    std::vector<CsvField> fields;
    const long first = line();
    while (!rest_.empty()) {
      const auto text = take_line(rest_);
      if (text.starts_with(kEndOfHeader)) return header;
      if (trim_blanks(text).empty()) continue;
      // Before the separator is known a tab or a comma behind the key may be it.
      const bool by_tabs = text.find('\t') != std::string_view::npos;
      CsvDialect dialect = dialect_;
      if (!by_tabs) dialect.separator = ',';
      split_fields(text, dialect, fields);
      const std::string key = to_utf8(fields[0].text);
      std::vector<std::string> row;
      for (std::size_t k = 1; k < fields.size(); ++k) row.push_back(to_utf8(fields[k].text));
      // "Decimal_Separator,," with a comma as separator reads as empty fields.
      if (key == "Decimal_Separator" && !by_tabs) {
        row.assign(1, text.substr(key.size()).starts_with(",,") ? "," : ".");
      }
      header.rows.emplace(key, std::move(row));
    }
    throw error(first, "", "a header without its end",
                "a header ends with a line \"" + std::string(kEndOfHeader) + "\"");
  }

  Segment read_segment() {
    Segment segment;
    segment.header = read_header();
    if (!skip_blank_lines()) throw error(line(), "", "a segment without a table", "record again");
    const long titles_line = line();
    std::vector<CsvField> titles;
    split_fields(take_line(rest_), dialect_, titles);
    if (titles.size() < 2 || (titles[0].text != "X_Value" && titles[0].text != "X")) {
      throw error(titles_line, to_utf8(titles[0].text.substr(0, 40)),
                  "the table's titles do not begin with X_Value",
                  "keep the titles that LabVIEW writes");
    }
    const std::string_view table = rest_;
    for (auto after = rest_; !after.empty(); rest_ = after) {
      if (trim_blanks(take_line(after)).empty()) break;
    }
    const std::size_t body_end = bytes_.size() - rest_.size();
    if (!decimal_known_ && dialect_.separator != ',') {
      // The sign that the numbers carry, where the file does not say.
      const auto head = table.substr(0, std::min(table.size() - rest_.size(), kHead));
      dialect_.decimal =
          std::count(head.begin(), head.end(), ',') > std::count(head.begin(), head.end(), '.')
              ? ','
              : '.';
    }
    CsvLayout& layout = segment.layout;
    layout.dialect = dialect_;
    layout.body = bytes_.size() - table.size();
    layout.body_line = titles_line + 1;
    layout.has_names = true;
    std::vector<bool> wanted;
    for (std::size_t c = 0; c < titles.size(); ++c) {
      const auto title = titles[c].text;
      const bool last = c + 1 == titles.size();
      CsvColumn column;
      column.name = to_utf8(title);
      wanted.push_back(!last || (title != "Comment" && !title.empty()));
      if (title == "X_Value" || (c == 0 && title == "X")) {
        segment.x_columns.push_back(c);
      } else if (wanted[c]) {
        segment.value_columns.push_back(c);
        column.unit = segment.header.at("Y_Unit_Label", c);
      }
      layout.columns.push_back(std::move(column));
    }
    if (segment.value_columns.empty()) {
      throw error(titles_line, "", "the table has no channel", "record again");
    }
    if (layout.body < body_end) {
      const auto text = bytes_.substr(0, body_end);
      find_csv_decimals(text, layout);
      segment.body = parse_csv_body(text, layout, wanted, file_, done_with_);
    }
    if (segment.body.rows == 0) {
      throw error(layout.body < body_end ? layout.body_line : titles_line, "",
                  "the table holds no numbers", "record again");
    }
    return segment;
  }

  static constexpr std::size_t kHead = 1 << 16;
  std::string_view bytes_, rest_;
  const std::string& file_;
  const std::function<void(std::size_t)>& done_with_;
  CsvDialect dialect_{'\t', '.'};
  bool decimal_known_ = false;
};

/// Delta_X as a rate, uncertain by its last printed digit.
RateOfStep stated_rate(const Header& header, std::size_t reference) {
  const std::string text = header.at("Delta_X", reference);
  const int decimals = std::max(printed_decimals(text, '.'), printed_decimals(text, ','));
  return rate_of_step(header.number("Delta_X", reference), 0.5 * std::pow(10.0, -decimals));
}

double start_of(const Header& header, std::size_t reference) {
  const double x0 = header.number("X0", reference);
  return std::isfinite(x0) ? x0 : 0;
}

/// Times of every segment on one axis, and the digits that they are printed with.
Eigen::VectorXd joined_times(const std::vector<const Segment*>& segments, std::size_t reference,
                             int& decimals) {
  constexpr int kExact = 400;
  Eigen::VectorXd time;
  const Header& first = segments.front()->header;
  int ignored = 0;
  bool all_have_x = true;
  double next_start = 0;
  for (const auto* segment : segments) {
    const Eigen::Index n = segment->body.rows, row = time.size();
    const double rate = stated_rate(segment->header, reference).rate_hz;
    const double step = rate > 0 ? 1 / rate : 0;
    Eigen::VectorXd x = segment->x_of(reference, row == 0 ? decimals : ignored);
    if (x.size() == 0) {
      all_have_x = false;
      x = start_of(segment->header, reference) +
          step * Eigen::ArrayXd::LinSpaced(n, 0, static_cast<double>(n - 1));
    }
    double offset = 0;
    if (row > 0) {
      // X may run on or begin anew; the clocks tell where a segment that begins anew belongs, but
      // not one set back, or one that does not resolve the segments.
      const double clock = segment->header.clock(reference), first_clock = first.clock(reference);
      const double by_clock = clock - first_clock - x[0] + start_of(first, reference);
      if (!(x[0] > time[row - 1])) {
        offset =
            clock > first_clock && x[0] + by_clock > time[row - 1] ? by_clock : next_start - x[0];
      }
      if (std::abs(x[0] + offset - next_start) < 0.5 * step) offset = next_start - x[0];
    }
    time.conservativeResize(row + n);
    time.tail(n) = x.array() + offset;
    next_start = time[row + n - 1] + step;
  }
  if (!all_have_x) decimals = kExact;
  return time;
}

/// A channel's numbers in all segments; the header's number of them is compared with the table's.
void take_channel(const std::vector<const Segment*>& segments, std::size_t c, std::size_t reference,
                  CsvTable& table) {
  const Segment& first = *segments.front();
  const double delta = first.header.number("Delta_X", c);
  const double reference_delta = first.header.number("Delta_X", reference);
  if (first.has_numbers(c) && delta > 0 && reference_delta > 0 &&
      std::abs(delta / reference_delta - 1) > 1e-6) {
    add_note(table.notes, "data_left_out", first.layout.columns[c].name,
             "is sampled at another rate than \"{}\" (Delta_X {} s): left out",
             first.layout.columns[reference].name, first.header.at("Delta_X", c));
    return;
  }
  Eigen::VectorXd numbers;
  double stated = 0;
  for (const auto* segment : segments) {
    numbers.conservativeResize(numbers.size() + segment->body.rows);
    numbers.tail(segment->body.rows) = segment->body.columns[c];
    const double samples = segment->header.number("Samples", c);
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
                   const ReadOptions& options, const std::function<void(std::size_t)>& done_with) {
  const std::string file = path.string();
  const std::vector<Segment> segments = LvmReader(bytes, file, done_with).read();
  const Segment& first = segments.front();
  const std::string dimension = first.header.at("X_Dimension", 1);
  if (!dimension.empty() && dimension != "Time") {
    throw RecordingError({file, line_number(bytes, bytes.find("X_Dimension")), 0, "", dimension},
                         "is no recording over time", "give a file whose X_Dimension is Time");
  }
  const auto filled = std::find_if(first.value_columns.begin(), first.value_columns.end(),
                                   [&](std::size_t c) { return first.has_numbers(c); });
  const std::size_t reference =
      filled == first.value_columns.end() ? first.value_columns.front() : *filled;

  CsvTable table;
  table.file = file;
  table.layout = first.layout;
  // Segments of other channels cannot be joined.
  std::vector<const Segment*> joined;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    if (segments[k].has_channels_of(first)) {
      joined.push_back(&segments[k]);
      if (segments[k].body.incomplete_last) {
        add_note(table.notes, "incomplete", "",
                 "the last line broke off before its end and is left out");
      }
      continue;
    }
    add_note(table.notes, "data_left_out", fmt::format("line {}", segments[k].layout.body_line),
             "segment {} has other channels than the first: left out", k + 1);
  }
  if (joined.size() > 1) {
    table.layout.body_line = 0;
    add_note(table.notes, "read_as", "", "{} segments are joined into one recording",
             joined.size());
  }
  const RateOfStep stated = stated_rate(first.header, reference);
  table.layout.stated_rate_hz = stated.rate_hz;
  table.layout.rate_text = "Delta_X = " + first.header.at("Delta_X", reference);
  CsvColumn x;
  x.name = "X_Value";
  x.unit = "s";
  const bool has_times = joined.size() > 1 || first.x_of(reference, x.decimals).size() > 0;
  if (has_times) {
    Eigen::VectorXd times = joined_times(joined, reference, x.decimals);
    table.add(x, 0, std::move(times));
  }
  for (const std::size_t c : first.value_columns) take_channel(joined, c, reference, table);
  Recording recording = recording_of_table(std::move(table), path, "lvm", options);
  if (has_times) return recording;
  recording.start_time_s = start_of(first.header, reference);
  if (options.sample_rate_hz > 0) return recording;
  recording.sample_rate_relative_std = stated.relative_std;
  // 20 ppm: what ordinary loggers' clocks are off by anyhow.
  if (stated.relative_std > 2e-5) {
    add_note(recording.notes, "read_as", "",
             "Give sample_rate_hz if it is known better: Delta_X is printed as {}, so "
             "{:.9g} Hz is uncertain by {:.2g} Hz, and every frequency in proportion",
             first.header.at("Delta_X", reference), stated.rate_hz,
             stated.relative_std * stated.rate_hz);
  }
  return recording;
}

}  // namespace rigfit::signal
