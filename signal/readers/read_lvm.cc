#include "signal/readers/read_lvm.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "signal/readers/csv/csv_body.h"
#include "signal/readers/csv/csv_layout.h"
#include "signal/readers/files/number_text.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/recording_time.h"
#include "signal/recording/time_axis.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

constexpr std::string_view kEndOfHeader = "***End_of_Header***";

using Row = std::vector<std::string>;

struct Header {
  std::map<std::string, Row> rows;  ///< by key; field k of the row at [k - 1]
  std::map<std::string, long> lines;

  [[nodiscard]] std::string at(const std::string& key, std::size_t column) const {
    const auto row = rows.find(key);
    return row == rows.end() || column == 0 || column > row->second.size()
               ? std::string()
               : row->second[column - 1];
  }
};

struct Segment {
  Header header;
  CsvLayout layout;
  CsvBody body;
  std::vector<std::size_t> value_columns, x_columns;
  std::size_t comment_column = 0;  ///< 0: none
};

class LvmReader {
 public:
  LvmReader(std::string_view bytes, const std::string& file,
            const std::function<void(std::size_t)>& done_with)
      : bytes_(bytes), file_(file), done_with_(done_with) {
    if (bytes_.substr(0, 3) == "\xEF\xBB\xBF") at_ = 3;
  }

  std::vector<Segment> read() {
    const Header file_header = read_header();
    const std::string separator = file_header.at("Separator", 1);
    if (separator == "Comma") {
      dialect_.separator = ',';
    } else if (!separator.empty() && separator != "Tab") {
      throw error(file_header.lines.at("Separator"), separator, "unknown separator",
                  "LVM knows Tab and Comma");
    }
    const std::string decimal = file_header.at("Decimal_Separator", 1);
    if (decimal == "," || decimal == ".") dialect_.decimal = decimal[0];
    decimal_known_ = !decimal.empty();
    // "Decimal_Separator<tab>," with a comma as separator reads as an empty field.
    std::vector<Segment> segments;
    while (skip_blank_lines()) segments.push_back(read_segment());
    if (segments.empty()) {
      throw error(line_of(at_), "", "holds a header but no measurement",
                  "record again; a segment has its own header and a table");
    }
    return segments;
  }

 private:
  [[nodiscard]] long line_of(std::size_t at) const {
    return line_number(bytes_, std::min(at, bytes_.size() - 1));
  }
  RecordingError error(long line, const std::string& value, std::string problem,
                       std::string remedy) const {
    return {{file_, line, 0, "", value}, std::move(problem), std::move(remedy)};
  }

  bool skip_blank_lines() {
    while (at_ < bytes_.size()) {
      const std::size_t end = line_end(bytes_, at_);
      if (!trim_blanks(bytes_.substr(at_, end - at_)).empty()) return true;
      at_ = next_line(bytes_, end);
    }
    return false;
  }

  Header read_header() {
    Header header;
    const std::size_t start = at_;
    std::vector<CsvField> fields;
    long line = line_of(at_);
    // The keys of a header are few; the table's dialect splits them, too.
    for (; at_ < bytes_.size(); ++line) {
      const std::size_t end = line_end(bytes_, at_);
      const auto text = bytes_.substr(at_, end - at_);
      at_ = next_line(bytes_, end);
      if (text.substr(0, kEndOfHeader.size()) == kEndOfHeader) return header;
      if (trim_blanks(text).empty()) continue;
      // Before the separator is known a tab or a comma behind the key may be it.
      CsvDialect dialect = dialect_;
      if (text.find('\t') == std::string_view::npos) dialect.separator = ',';
      split_fields(text, dialect, fields);
      const std::string key = to_utf8(fields[0].text);
      Row row;
      for (std::size_t k = 1; k < fields.size(); ++k) row.push_back(to_utf8(fields[k].text));
      if (key == "Decimal_Separator" && text.find('\t') == std::string_view::npos) {
        row.assign(1, text.size() > key.size() + 1 && text[key.size() + 1] == ',' ? "," : ".");
      }
      header.rows.emplace(key, std::move(row));
      header.lines.emplace(key, line);
    }
    throw error(line_of(start), "", "a header without its end",
                "a header ends with a line \"" + std::string(kEndOfHeader) + "\"");
  }

  /// A decimal comma where the file does not say: the sign that the numbers carry.
  void find_decimal(std::string_view table) {
    if (decimal_known_ || dialect_.separator == ',') return;
    const auto head = table.substr(0, 1 << 16);
    const auto commas = std::count(head.begin(), head.end(), ',');
    const auto points = std::count(head.begin(), head.end(), '.');
    dialect_.decimal = commas > points ? ',' : '.';
  }

  Segment read_segment() {
    Segment segment;
    segment.header = read_header();
    if (!skip_blank_lines()) {
      throw error(line_of(at_), "", "a segment without a table", "record again");
    }
    const std::size_t titles_at = at_;
    const std::size_t titles_end = line_end(bytes_, at_);
    std::vector<CsvField> fields;
    split_fields(bytes_.substr(titles_at, titles_end - titles_at), dialect_, fields);
    if (fields.size() < 2 || (fields[0].text != "X_Value" && fields[0].text != "X")) {
      throw error(line_of(titles_at), to_utf8(fields[0].text.substr(0, 40)),
                  "the table's titles do not begin with X_Value",
                  "keep the titles that LabVIEW writes");
    }
    const std::size_t body = next_line(bytes_, titles_end);
    std::size_t body_end = body;
    while (body_end < bytes_.size()) {
      const std::size_t end = line_end(bytes_, body_end);
      if (trim_blanks(bytes_.substr(body_end, end - body_end)).empty()) break;
      body_end = next_line(bytes_, end);
    }
    find_decimal(bytes_.substr(body, body_end - body));
    segment.layout.dialect = dialect_;
    segment.layout.body = body;
    segment.layout.body_line = line_of(titles_at) + 1;
    segment.layout.has_names = true;
    std::vector<bool> wanted;
    for (std::size_t c = 0; c < fields.size(); ++c) {
      CsvColumn column;
      column.name = to_utf8(fields[c].text);
      const bool is_x = fields[c].text == "X_Value" || (c == 0 && fields[c].text == "X");
      const bool is_comment = c + 1 == fields.size() && fields[c].text == "Comment";
      const bool is_nothing = c + 1 == fields.size() && fields[c].text.empty();
      if (is_x) {
        segment.x_columns.push_back(c);
      } else if (is_comment) {
        segment.comment_column = c;
        column.kind = ColumnKind::text;
      } else if (!is_nothing) {
        segment.value_columns.push_back(c);
        column.unit = segment.header.at("Y_Unit_Label", c);
      }
      wanted.push_back(!is_comment && !is_nothing);
      segment.layout.columns.push_back(std::move(column));
    }
    if (segment.value_columns.empty()) {
      throw error(line_of(titles_at), "", "the table has no channel", "record again");
    }
    if (body >= body_end) {
      throw error(line_of(titles_at), "", "the table holds no numbers", "record again");
    }
    segment.body =
        parse_csv_body(bytes_.substr(0, body_end), segment.layout, wanted, file_, done_with_);
    if (segment.body.rows == 0) {
      throw error(segment.layout.body_line, "", "the table holds no numbers", "record again");
    }
    at_ = body_end;
    return segment;
  }

  std::string_view bytes_;
  const std::string& file_;
  const std::function<void(std::size_t)>& done_with_;
  std::size_t at_ = 0;
  CsvDialect dialect_{'\t', '.'};
  bool decimal_known_ = false;
};

double number_at(const Header& header, const std::string& key, std::size_t column) {
  double value = std::numeric_limits<double>::quiet_NaN();
  const std::string text = header.at(key, column);
  if (text.empty()) return value;
  if (!parse_whole_number(text, '.', value) && !parse_whole_number(text, ',', value)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return value;
}

/// Seconds of a segment's Date and Time; NaN when it has none.
double clock_of(const Header& header, std::size_t column) {
  double seconds = 0;
  int decimals = 0;
  const std::string text = header.at("Date", column) + " " + header.at("Time", column);
  return parse_clock(text, seconds, decimals) ? seconds : std::numeric_limits<double>::quiet_NaN();
}

struct SegmentTimes {
  double start_s = 0;
  double stated_rate_hz = 0;
  /// Uncertainty of the stated rate: its step is printed with few digits.
  double rate_relative_std = 0;
  Eigen::VectorXd x;  ///< empty: no X column
  double printed_resolution_s = 0;
};

bool has_numbers(const Segment& segment, std::size_t column) {
  return segment.body.missing[column] < segment.body.rows;
}

SegmentTimes times_of(const Segment& segment, std::size_t reference) {
  SegmentTimes times;
  const double delta = number_at(segment.header, "Delta_X", reference);
  const double x0 = number_at(segment.header, "X0", reference);
  if (delta > 0 && std::isfinite(1 / delta)) {
    const std::string text = segment.header.at("Delta_X", reference);
    const double half_digit =
        0.5 * std::pow(10.0, -std::max(printed_decimals(text, '.'), printed_decimals(text, ',')));
    const RateOfStep rate = rate_of_step(delta, half_digit);
    times.stated_rate_hz = rate.rate_hz;
    times.rate_relative_std = rate.relative_std;
  }
  times.start_s = std::isfinite(x0) ? x0 : 0;
  for (const std::size_t c : segment.x_columns) {
    // The X column in front of the reference channel, or the only one.
    if (c > reference || !has_numbers(segment, c)) continue;
    times.x = segment.body.columns[c];
    times.printed_resolution_s = std::pow(10.0, -segment.body.decimals[c]);
  }
  return times;
}

}  // namespace

Recording read_lvm(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options, const std::function<void(std::size_t)>& done_with) {
  const std::string file = path.string();
  std::vector<Segment> segments = LvmReader(bytes, file, done_with).read();
  Recording recording;
  recording.path = path;
  recording.format = "lvm";

  Segment& first = segments.front();
  const std::string dimension = first.header.at("X_Dimension", 1);
  if (!dimension.empty() && dimension != "Time") {
    throw RecordingError({file, first.header.lines.at("X_Dimension"), 0, "", dimension},
                         "is no recording over time", "give a file whose X_Dimension is Time");
  }
  std::size_t reference = first.value_columns.front();
  for (const std::size_t c : first.value_columns) {
    if (has_numbers(first, c)) {
      reference = c;
      break;
    }
  }

  // Segments of other channels cannot be joined.
  std::vector<const Segment*> joined{&first};
  for (std::size_t k = 1; k < segments.size(); ++k) {
    bool same = segments[k].layout.columns.size() == first.layout.columns.size();
    for (std::size_t c = 0; same && c < first.layout.columns.size(); ++c) {
      same = segments[k].layout.columns[c].name == first.layout.columns[c].name &&
             segments[k].layout.columns[c].unit == first.layout.columns[c].unit;
    }
    if (same) {
      joined.push_back(&segments[k]);
    } else {
      recording.notes.push_back(
          {"data_left_out",
           "segment " + std::to_string(k + 1) + " has other channels than the first: left out",
           "line " + std::to_string(segments[k].layout.body_line)});
    }
  }
  Eigen::Index total = 0;
  for (const auto* segment : joined) total += segment->body.rows;

  // Times of every segment on one axis.
  const double first_clock = clock_of(first.header, reference);
  Eigen::VectorXd time(total);
  const SegmentTimes first_times = times_of(first, reference);
  bool have_x = first_times.x.size() > 0;
  double resolution = first_times.printed_resolution_s;
  Eigen::Index row = 0;
  double next_start = 0;
  for (std::size_t k = 0; k < joined.size(); ++k) {
    const SegmentTimes times = times_of(*joined[k], reference);
    const Eigen::Index n = joined[k]->body.rows;
    const double clock = clock_of(joined[k]->header, reference);
    const double step = times.stated_rate_hz > 0 ? 1 / times.stated_rate_hz : 0;
    double offset = 0;
    if (k > 0) {
      // X may run on or begin anew; the clocks tell where a segment that begins anew belongs.
      const double begins = times.x.size() > 0 ? times.x[0] : times.start_s;
      if (!(begins > time[row - 1])) {
        offset = std::isfinite(clock) && std::isfinite(first_clock) && clock > first_clock
                     ? clock - first_clock - begins + first_times.start_s
                     : next_start - begins;
        // A clock set back, or one that does not resolve the segments.
        if (begins + offset <= time[row - 1]) offset = next_start - begins;
      }
      if (std::abs(begins + offset - next_start) < 0.5 * step) offset = next_start - begins;
    }
    if (times.x.size() > 0) {
      time.segment(row, n) = times.x.array() + offset;
    } else {
      have_x = false;
      for (Eigen::Index j = 0; j < n; ++j) {
        time[row + j] = times.start_s + offset + static_cast<double>(j) * step;
      }
    }
    row += n;
    next_start = time[row - 1] + step;
  }
  if (joined.size() > 1) {
    recording.notes.push_back(
        {"read_as", std::to_string(joined.size()) + " segments are joined into one recording", ""});
  }

  if (have_x || joined.size() > 1) {
    TimeAxisOptions axis_options;
    axis_options.printed_resolution_s = have_x ? resolution : 0;
    axis_options.stated_rate_hz = first_times.stated_rate_hz;
    const TimeAxis axis = time_axis(time, axis_options);
    recording.sample_rate_hz = axis.rate_hz;
    recording.start_time_s = std::isfinite(axis.start_s) ? axis.start_s : 0;
    recording.time_jitter_s = axis.jitter_s;
    if (!axis.agrees_with_stated && axis.rate_hz > 0) {
      recording.notes.push_back(
          {"rates_disagree",
           fmt::format(
               "the X values give {:.9g} Hz, Delta_X says {:.9g} Hz: the X values are taken",
               axis.rate_hz, first_times.stated_rate_hz),
           ""});
    }
    if (!axis.uniform && axis.rate_hz > 0) {
      if (axis.missing > 0) {
        throw RecordingError({file, first.layout.body_line, 1, "X_Value", ""},
                             "X values are missing and sampling is not uniform",
                             "record again, or delete the X columns");
      }
      recording.time_s = time;
      recording.notes.push_back(not_uniform_note(axis));
    }
  } else {
    recording.start_time_s = first_times.start_s;
  }
  if (recording.sample_rate_hz == 0) {
    recording.sample_rate_hz = first_times.stated_rate_hz;
    recording.sample_rate_relative_std = first_times.rate_relative_std;
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

  std::set<std::string> used;
  const double reference_delta = number_at(first.header, "Delta_X", reference);
  for (const std::size_t c : first.value_columns) {
    const CsvColumn& column = first.layout.columns[c];
    Channel channel;
    channel.name = column.name.empty() ? "column " + std::to_string(c + 1) : column.name;
    channel.name = unused_name(channel.name, used);
    const double delta = number_at(first.header, "Delta_X", c);
    if (has_numbers(first, c) && delta > 0 && reference_delta > 0 &&
        std::abs(delta / reference_delta - 1) > 1e-6) {
      recording.notes.push_back({"data_left_out",
                                 "is sampled at another rate than \"" +
                                     first.layout.columns[reference].name + "\" (Delta_X " +
                                     first.header.at("Delta_X", c) + " s): left out",
                                 channel.name});
      continue;
    }
    take_unit(column.unit, channel, recording.notes);
    Eigen::VectorXd numbers(total);
    Eigen::Index at = 0;
    double stated = 0;
    for (const auto* segment : joined) {
      numbers.segment(at, segment->body.rows) = segment->body.columns[c];
      at += segment->body.rows;
      const double samples = number_at(segment->header, "Samples", c);
      if (std::isfinite(samples)) stated += samples;
    }
    take_samples(std::move(numbers), channel);
    const auto held = static_cast<double>(total - channel.missing_samples);
    if (channel.missing_samples == total) {
      recording.notes.push_back({"no_samples", "holds no number at all", channel.name});
    } else if (stated > 0 && stated != held) {
      recording.notes.push_back(
          {"read_as",
           "the header states " + std::to_string(std::llround(std::min(stated, 1e15))) +
               " samples, the table holds " + std::to_string(std::llround(held)),
           channel.name});
    }
    recording.channels.push_back(std::move(channel));
  }
  note_unitless(recording);
  for (const auto* segment : joined) {
    if (segment->body.incomplete_last) {
      recording.notes.push_back(
          {"incomplete", "the last line broke off before its end and is left out", ""});
    }
  }
  return recording;
}

}  // namespace rigfit::signal
