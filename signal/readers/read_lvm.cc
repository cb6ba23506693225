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
  std::map<std::string, long> lines;

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
      throw error(header.lines.at("Separator"), separator, "unknown separator",
                  "LVM knows Tab and Comma");
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
    for (long number = first; !rest_.empty(); ++number) {
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
      header.lines.emplace(key, number);
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

struct SegmentTimes {
  double start_s = 0;
  RateOfStep stated;  ///< by Delta_X
  Eigen::VectorXd x;  ///< empty: no X column
  double printed_resolution_s = 0;
};

SegmentTimes times_of(const Segment& segment, std::size_t reference) {
  SegmentTimes times;
  const std::string text = segment.header.at("Delta_X", reference);
  const int decimals = std::max(printed_decimals(text, '.'), printed_decimals(text, ','));
  times.stated =
      rate_of_step(segment.header.number("Delta_X", reference), 0.5 * std::pow(10.0, -decimals));
  const double x0 = segment.header.number("X0", reference);
  times.start_s = std::isfinite(x0) ? x0 : 0;
  for (const std::size_t c : segment.x_columns) {
    // The X column in front of the reference channel, or the only one.
    if (c > reference || !segment.has_numbers(c)) continue;
    times.x = segment.body.columns[c];
    times.printed_resolution_s = std::pow(10.0, -segment.layout.columns[c].decimals);
  }
  return times;
}

/// Times of every segment on one axis. `have_x`: of X columns, each as printed.
Eigen::VectorXd joined_times(const std::vector<const Segment*>& segments, std::size_t reference,
                             bool& have_x) {
  Eigen::Index total = 0;
  for (const auto* segment : segments) total += segment->body.rows;
  Eigen::VectorXd time(total);
  const SegmentTimes first = times_of(*segments.front(), reference);
  const double first_clock = segments.front()->header.clock(reference);
  have_x = first.x.size() > 0;
  Eigen::Index row = 0;
  double next_start = 0;
  for (const auto* segment : segments) {
    const SegmentTimes times = times_of(*segment, reference);
    const Eigen::Index n = segment->body.rows;
    const double step = times.stated.rate_hz > 0 ? 1 / times.stated.rate_hz : 0;
    const double begins = times.x.size() > 0 ? times.x[0] : times.start_s;
    double offset = 0;
    if (row > 0) {
      // X may run on or begin anew; the clocks tell where a segment that begins anew belongs, but
      // not one set back, or one that does not resolve the segments.
      const double clock = segment->header.clock(reference);
      const double by_clock = clock - first_clock - begins + first.start_s;
      if (!(begins > time[row - 1])) {
        offset = clock > first_clock && begins + by_clock > time[row - 1] ? by_clock
                                                                          : next_start - begins;
      }
      if (std::abs(begins + offset - next_start) < 0.5 * step) offset = next_start - begins;
    }
    have_x = have_x && times.x.size() > 0;
    for (Eigen::Index j = 0; j < n; ++j) {
      time[row + j] = offset + (times.x.size() > 0 ? times.x[j]
                                                   : times.start_s + static_cast<double>(j) * step);
    }
    row += n;
    next_start = time[row - 1] + step;
  }
  return time;
}

/// Rate, start and times of the segments.
void take_times(const std::vector<const Segment*>& segments, std::size_t reference,
                const ReadOptions& options, Recording& recording) {
  const Segment& first = *segments.front();
  const SegmentTimes times = times_of(first, reference);
  recording.start_time_s = times.start_s;
  bool have_x = false;
  const Eigen::VectorXd time = joined_times(segments, reference, have_x);
  if (have_x || segments.size() > 1) {
    const double printed = have_x ? times.printed_resolution_s : 0;
    signal::take_times(time_axis(time, {printed, times.stated.rate_hz}),
                       {time, printed, fmt::format("Delta_X says {:.9g} Hz", times.stated.rate_hz),
                        "", "X_Value", segments.size() > 1 ? 0 : first.layout.body_line},
                       recording);
  }
  if (recording.sample_rate_hz == 0) {
    recording.sample_rate_hz = times.stated.rate_hz;
    recording.sample_rate_relative_std = times.stated.relative_std;
  }
  take_stated_rate(options.sample_rate_hz, recording);
  // 20 ppm: what ordinary loggers' clocks are off by anyhow.
  if (recording.sample_rate_relative_std > 2e-5) {
    recording.notes.push_back(
        {"read_as",
         fmt::format(
             "Give sample_rate_hz if it is known better: Delta_X is printed as {}, so {:.9g} Hz "
             "is uncertain by {:.2g} Hz, and every frequency in proportion",
             first.header.at("Delta_X", reference), recording.sample_rate_hz,
             recording.sample_rate_relative_std * recording.sample_rate_hz),
         ""});
  }
  if (recording.sample_rate_hz == 0) {
    recording.notes.push_back(
        {"no_sample_rate", "Give the sample rate: neither X values nor Delta_X state it", ""});
  }
}

void take_channel(const std::vector<const Segment*>& segments, std::size_t c, std::size_t reference,
                  std::set<std::string>& used, Recording& recording) {
  const Segment& first = *segments.front();
  const CsvColumn& column = first.layout.columns[c];
  Channel channel;
  channel.name =
      unused_name(column.name.empty() ? "column " + std::to_string(c + 1) : column.name, used);
  const double delta = first.header.number("Delta_X", c);
  const double reference_delta = first.header.number("Delta_X", reference);
  if (first.has_numbers(c) && delta > 0 && reference_delta > 0 &&
      std::abs(delta / reference_delta - 1) > 1e-6) {
    recording.notes.push_back(
        {"data_left_out",
         fmt::format("is sampled at another rate than \"{}\" (Delta_X {} s): left out",
                     first.layout.columns[reference].name, first.header.at("Delta_X", c)),
         channel.name});
    return;
  }
  take_unit(column.unit, channel, recording.notes);
  Eigen::Index total = 0;
  for (const auto* segment : segments) total += segment->body.rows;
  Eigen::VectorXd numbers(total);
  Eigen::Index at = 0;
  double stated = 0;
  for (const auto* segment : segments) {
    numbers.segment(at, segment->body.rows) = segment->body.columns[c];
    at += segment->body.rows;
    const double samples = segment->header.number("Samples", c);
    if (std::isfinite(samples)) stated += samples;
  }
  take_samples(std::move(numbers), channel);
  const auto held = static_cast<double>(total - channel.missing_samples);
  if (channel.missing_samples == total) {
    recording.notes.push_back({"no_samples", "holds no number at all", channel.name});
  } else if (stated > 0 && stated != held) {
    recording.notes.push_back(
        {"read_as",
         fmt::format("the header states {:.0f} samples, the table holds {:.0f}",
                     std::min(stated, 1e15), held),
         channel.name});
  }
  recording.channels.push_back(std::move(channel));
}

}  // namespace

Recording read_lvm(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options, const std::function<void(std::size_t)>& done_with) {
  const std::string file = path.string();
  const std::vector<Segment> segments = LvmReader(bytes, file, done_with).read();
  Recording recording;
  recording.path = path;
  recording.format = "lvm";
  const Segment& first = segments.front();
  const std::string dimension = first.header.at("X_Dimension", 1);
  if (!dimension.empty() && dimension != "Time") {
    throw RecordingError({file, first.header.lines.at("X_Dimension"), 0, "", dimension},
                         "is no recording over time", "give a file whose X_Dimension is Time");
  }
  const auto filled = std::find_if(first.value_columns.begin(), first.value_columns.end(),
                                   [&](std::size_t c) { return first.has_numbers(c); });
  const std::size_t reference =
      filled == first.value_columns.end() ? first.value_columns.front() : *filled;

  // Segments of other channels cannot be joined.
  std::vector<const Segment*> joined;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    if (segments[k].has_channels_of(first)) {
      joined.push_back(&segments[k]);
      continue;
    }
    recording.notes.push_back(
        {"data_left_out",
         fmt::format("segment {} has other channels than the first: left out", k + 1),
         fmt::format("line {}", segments[k].layout.body_line)});
  }
  if (joined.size() > 1) {
    recording.notes.push_back(
        {"read_as", fmt::format("{} segments are joined into one recording", joined.size()), ""});
  }
  take_times(joined, reference, options, recording);
  std::set<std::string> used;
  for (const std::size_t c : first.value_columns) {
    take_channel(joined, c, reference, used, recording);
  }
  note_unitless(recording);
  for (const auto* segment : joined) {
    if (!segment->body.incomplete_last) continue;
    recording.notes.push_back(
        {"incomplete", "the last line broke off before its end and is left out", ""});
  }
  return recording;
}

}  // namespace rigfit::signal
