#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "signal/numerics/numbers.h"
#include "signal/readers/csv_fields.h"
#include "signal/readers/csv_table.h"
#include "signal/readers/read_recording.h"
#include "signal/recording/recording_time.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

constexpr std::string_view kEndOfHeader = "***End_of_Header***";

/// The file's header or that of a segment: by key, field k at [k - 1].
struct LvmHeader {
  std::map<std::string, std::vector<std::string>> rows;

  [[nodiscard]] std::string text(const std::string& key, std::size_t column) const {
    const auto row = rows.find(key);
    return row == rows.end() || column == 0 || column > row->second.size()
               ? std::string()
               : row->second[column - 1];
  }
  [[nodiscard]] double number(const std::string& key, std::size_t column, double otherwise) const {
    double value = 0;
    const std::string own = text(key, column);
    return (parse_whole_number(own, '.', value) || parse_whole_number(own, ',', value)) &&
                   std::isfinite(value)
               ? value
               : otherwise;
  }
  /// Delta_X as a rate, uncertain by its last printed digit.
  [[nodiscard]] RateOfStep rate(std::size_t column) const {
    const std::string own = text("Delta_X", column);
    const int decimals = std::max(printed_decimals(own, '.'), printed_decimals(own, ','));
    return rate_of_step(number("Delta_X", column, 0), 0.5 * std::pow(10.0, -decimals));
  }
};

/// Reads the segments of a file, header and table each, and joins them.
class LvmReader {
 public:
  LvmReader(std::string_view bytes, const std::filesystem::path& path, const ReadOptions& options)
      : bytes_(bytes), rest_(bytes), path_(path), options_(options) {
    if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
    table_.file = path.string();
  }

  Recording read() {
    const LvmHeader file = read_header();
    if (file.text("Separator", 1) == "Comma") dialect_.separator = ',';
    if (file.text("Decimal_Separator", 1) == ",") dialect_.decimal = ',';
    for (; skip_blank_lines(); ++segments_) read_segment();
    if (segments_ == 0) throw error(rest_, "holds a header but no measurement", "record again");
    return joined();
  }

 private:
  /// About the line that a part of the file begins in.
  [[nodiscard]] RecordingError error(std::string_view part, std::string problem,
                                     std::string remedy) const {
    return text_error(bytes_, table_.file, part.substr(0, 0), std::move(problem),
                      std::move(remedy));
  }
  [[nodiscard]] static bool has_numbers(const Eigen::VectorXd& column) {
    return !column.array().isNaN().all();
  }

  /// Whether a line follows that is not blank.
  bool skip_blank_lines() {
    for (auto after = rest_; !after.empty(); rest_ = after) {
      if (!trim_blanks(take_line(after)).empty()) return true;
    }
    return false;
  }

  LvmHeader read_header() {
    LvmHeader header;
    std::vector<CsvField> fields;
    const std::string_view first = rest_;
    while (!rest_.empty()) {
      const auto text = take_line(rest_);
      if (text.starts_with(kEndOfHeader)) return header;
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
      header.rows.emplace(key, std::move(row));
    }
    throw error(first, "a header without its end",
                "a header ends with a line \"" + std::string(kEndOfHeader) + "\"");
  }

  void read_segment() {
    LvmHeader header = read_header();
    skip_blank_lines();
    const std::string_view titles_line = take_line(rest_);
    std::vector<CsvField> titles;
    split_fields(titles_line, dialect_, titles);
    if (titles.size() < 2 || (titles[0].text != "X_Value" && titles[0].text != "X")) {
      throw error(titles_line, "the titles of a table, X_Value first, are missing",
                  "keep the titles that LabVIEW writes");
    }
    const std::size_t begin = bytes_.size() - rest_.size();
    for (auto after = rest_; !after.empty(); rest_ = after) {
      if (trim_blanks(take_line(after)).empty()) break;
    }
    const auto text = bytes_.substr(0, bytes_.size() - rest_.size());
    CsvLayout layout;
    layout.dialect = dialect_;
    layout.body = begin;
    layout.body_line = line_number(bytes_, begin);
    layout.has_names = true;
    std::vector<bool> wanted;
    std::vector<std::size_t> values, x_columns;
    for (std::size_t c = 0; c < titles.size(); ++c) {
      const auto title = titles[c].text;
      CsvColumn column;
      column.name = to_utf8(title);
      wanted.push_back(c + 1 < titles.size() || (title != "Comment" && !title.empty()));
      if (title == "X_Value" || (c == 0 && title == "X")) {
        x_columns.push_back(c);
      } else if (wanted[c]) {
        values.push_back(c);
        column.unit = header.text("Y_Unit_Label", c);
      }
      layout.columns.push_back(std::move(column));
    }
    if (begin >= text.size() || values.empty()) {
      throw error(titles_line, "the table holds no numbers", "record again");
    }
    find_csv_decimals(text, layout);
    auto columns =
        parse_csv_body(text, layout, wanted, table_.file, table_.notes, options_.done_with);
    const auto is_same = [](const CsvColumn& a, const CsvColumn& b) {
      return a.name == b.name && a.unit == b.unit;
    };
    if (segments_ == 0) {
      table_.layout = layout;
      first_ = header;
      values_ = values;
      const auto filled =
          std::ranges::find_if(values, [&](std::size_t c) { return has_numbers(columns[c]); });
      reference_ = filled == values.end() ? values.front() : *filled;
      columns_.resize(titles.size());
      has_other_times_.resize(titles.size());
      stated_.resize(titles.size());
    } else if (!std::ranges::equal(layout.columns, table_.layout.columns, is_same)) {
      throw error(bytes_.substr(begin),
                  fmt::format("segment {} has other channels than the first", segments_ + 1),
                  "split the file into one for each kind of segment");
    }
    // The column of X values in front of a channel, or the only one.
    const auto x_of = [&](std::size_t channel) {
      return std::find_if(x_columns.rbegin(), x_columns.rend(),
                          [&](std::size_t c) { return c <= channel && has_numbers(columns[c]); });
    };
    const auto x = x_of(reference_);
    const bool has_x = x != x_columns.rend();
    append_times(header, has_x ? columns[*x] : Eigen::VectorXd(), columns[reference_].size());
    if (segments_ == 0 && has_x) decimals_ = layout.columns[*x].decimals;
    for (const std::size_t c : values) {
      if (const auto own = x_of(c); has_x && own != x_columns.rend() && own != x) {
        const Eigen::ArrayXd apart = (columns[*own] - columns[*x]).array().abs();
        has_other_times_[c] = has_other_times_[c] || (apart > kSameTimes * delta_x(c)).any();
      }
    }
    if (!has_x) decimals_ = kAllDigits;
    has_x_ |= has_x;
    for (const std::size_t c : values_) {
      append(columns[c], columns_[c]);
      stated_[c] += header.number("Samples", c, 0);
    }
  }

  static void append(const Eigen::VectorXd& more, Eigen::VectorXd& all) {
    all.conservativeResize(all.size() + more.size());
    all.tail(more.size()) = more;
  }

  [[nodiscard]] double delta_x(std::size_t column) const {
    return first_.number("Delta_X", column, 0);
  }

  /// Times of every segment on one axis: `x`, or from X0 in steps of Delta_X.
  void append_times(const LvmHeader& header, Eigen::VectorXd x, Eigen::Index rows) {
    const double rate = header.rate(reference_).rate_hz, step = rate > 0 ? 1 / rate : 0;
    const auto x0 = [&](const LvmHeader& of) { return of.number("X0", reference_, 0); };
    if (x.size() == 0) {
      x = x0(header) + step * Eigen::ArrayXd::LinSpaced(rows, 0, static_cast<double>(rows - 1));
    }
    if (segments_ > 0) {
      const double last = times_[times_.size() - 1], next = last + step;
      if (!(x[0] > last)) {
        throw error(rest_,
                    fmt::format("segment {} begins at X = {:.9g} s, but the one in front ends "
                                "at {:.9g} s",
                                segments_ + 1, x[0], last),
                    "split the file into one for each segment");
      }
      if (std::abs(x[0] - next) < 0.5 * step) x.array() += next - x[0];
    }
    append(x, times_);
  }

  /// A channel's numbers in all segments; the header's number of them is compared with the table's.
  void take_channel(std::size_t c) {
    const auto& names = table_.layout.columns;
    const double late = first_.number("X0", c, 0) - first_.number("X0", reference_, 0);
    const double usual = delta_x(reference_);
    const bool other_rate = delta_x(c) > 0 && usual > 0 && std::abs(delta_x(c) / usual - 1) > 1e-6;
    const bool other_start = usual > 0 && std::abs(late) > kSameTimes * usual;
    if (has_numbers(columns_[c]) && (other_rate || other_start || has_other_times_[c])) {
      add_note(
          table_.notes, "data_left_out", names[c].name,
          "is sampled at other times than \"{}\" (X0 {}, Delta_X {}): left out; export it to a "
          "file of its own",
          names[reference_].name, first_.text("X0", c), first_.text("Delta_X", c));
      return;
    }
    table_.add(names[c], c, std::move(columns_[c]));
    const Channel& channel = table_.channels.back();
    const auto held = static_cast<double>(channel.samples.size() - channel.missing_samples);
    if (held > 0 && stated_[c] > 0 && stated_[c] != held) {
      add_note(table_.notes, "read_as", channel.name,
               "the header states {:.0f} samples, the table holds {:.0f}",
               std::min(stated_[c], 1e15), held);
    }
  }

  Recording joined() {
    const std::string dimension = first_.text("X_Dimension", 1);
    if (!dimension.empty() && dimension != "Time") {
      throw error(bytes_.substr(bytes_.find("X_Dimension")),
                  "is a recording over " + dimension + ", not over time",
                  "give a file whose X_Dimension is Time");
    }
    const std::string delta = first_.text("Delta_X", reference_);
    const RateOfStep stated = first_.rate(reference_);
    table_.layout.stated_rate_hz = stated.rate_hz;
    table_.layout.rate_text = "Delta_X = " + delta;
    if (segments_ > 1) {
      table_.layout.body_line = 0;
      add_note(table_.notes, "read_as", "", "{} segments are joined into one recording", segments_);
    }
    const bool has_times = segments_ > 1 || has_x_;
    if (has_times) {
      CsvColumn x{"X_Value", "s"};
      x.decimals = decimals_;
      table_.add(x, 0, std::move(times_));
    }
    for (const std::size_t c : values_) take_channel(c);
    Recording recording = recording_of_table(std::move(table_), path_, "lvm", options_);
    if (has_times) return recording;
    recording.start_time_s = first_.number("X0", reference_, 0);
    if (options_.sample_rate_hz > 0) return recording;
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

  static constexpr int kAllDigits = 400;
  static constexpr double kSameTimes = 0.01;  // steps, as TimeAxis takes sampling as uniform
  std::string_view bytes_, rest_;
  const std::filesystem::path& path_;
  const ReadOptions& options_;
  CsvDialect dialect_{'\t', '.'};
  // The segments so far: the first one's header, columns and the channel whose times serve for
  // all; times and numbers, by column.
  long segments_ = 0;
  LvmHeader first_;
  CsvTable table_;
  std::vector<std::size_t> values_;
  std::size_t reference_ = 0;
  Eigen::VectorXd times_;
  int decimals_ = kAllDigits;
  bool has_x_ = false;
  std::vector<Eigen::VectorXd> columns_;
  std::vector<double> stated_;
  std::vector<bool> has_other_times_;  ///< by column
};

}  // namespace

Recording read_lvm(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options) {
  return LvmReader(bytes, path, options).read();
}

}  // namespace rigfit::signal
