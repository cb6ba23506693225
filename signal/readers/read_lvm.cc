
#include "signal/readers/csv_table.h"
#include "signal/readers/read_recording.h"
#include "signal/recording/recording_time.h"

namespace rigfit::signal {
namespace {

constexpr std::string_view kEndOfHeader = "***End_of_Header***";

/// The file's header or that of its segment: by key, field k at [k - 1].
struct LvmHeader {
  std::map<std::string, std::vector<std::string>> rows;

  [[nodiscard]] std::string text(const std::string& key, std::size_t column) const {
    const auto row = rows.find(key);
    return row == rows.end() || column == 0 || column > row->second.size()
               ? std::string()
               : row->second[column - 1];
  }
  [[nodiscard]] double number(const std::string& key, std::size_t column) const {
    double value = 0;
    const std::string own = text(key, column);
    return (parse_whole_number(own, '.', value) || parse_whole_number(own, ',', value)) &&
                   std::isfinite(value)
               ? value
               : 0;
  }
  /// Delta_X as a rate, uncertain by its last printed digit.
  [[nodiscard]] RateOfStep rate(std::size_t column) const {
    const std::string own = text("Delta_X", column);
    const int decimals = std::max(printed_decimals(own, '.'), printed_decimals(own, ','));
    return rate_of_step(number("Delta_X", column), 0.5 * std::pow(10.0, -decimals));
  }
};

/// Reads a file of one segment: the file's header, the segment's, and a table.
class LvmReader {
 public:
  LvmReader(std::string_view bytes, const std::filesystem::path& path, const ReadOptions& options)
      : bytes_(text_without_mark(bytes, path.string())),
        rest_(bytes_),
        path_(path),
        options_(options) {
    table_.file = path.string();
    table_.layout.dialect.separator = '\t';
  }

  Recording read() {
    header_ = read_header();
    CsvLayout& layout = table_.layout;
    if (header_.text("Separator", 1) == "Comma") layout.dialect.separator = ',';
    if (header_.text("Decimal_Separator", 1) == ",") layout.dialect.decimal = ',';
    if (!skip_blank_lines()) {
      throw error(rest_, "holds a header but no measurement", "record again");
    }
    header_ = read_header();
    if (const auto dimension = header_.text("X_Dimension", 1);
        !dimension.empty() && dimension != "Time") {
      throw error(bytes_.substr(bytes_.find("X_Dimension")),
                  "is a recording over " + dimension + ", not over time",
                  "give a file whose X_Dimension is Time");
    }
    return recording_of(read_columns());
  }

 private:
  /// About the line that a part of the file begins in.
  [[nodiscard]] RecordingError error(std::string_view part, std::string problem,
                                     std::string remedy) const {
    return text_error(bytes_, table_.file, part.substr(0, 0), std::move(problem),
                      std::move(remedy));
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
      split_fields(text, {by_tabs ? table_.layout.dialect.separator : ',', '.'}, fields);
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

  /// The titles and the table below them; columns of X values and of channels.
  std::vector<VectorXd> read_columns() {
    skip_blank_lines();
    CsvLayout& layout = table_.layout;
    const std::string_view titles_line = take_line(rest_);
    std::vector<CsvField> titles;
    split_fields(titles_line, layout.dialect, titles);
    if (titles.size() < 2 || (titles[0].text != "X_Value" && titles[0].text != "X")) {
      throw error(titles_line, "the titles of a table, X_Value first, are missing",
                  "keep the titles that LabVIEW writes");
    }
    layout.body = bytes_.size() - rest_.size();
    for (auto after = rest_; !after.empty(); rest_ = after) {
      if (trim_blanks(take_line(after)).empty()) break;
    }
    const auto text = bytes_.substr(0, bytes_.size() - rest_.size());
    if (skip_blank_lines()) {
      throw error(rest_, "a second segment begins here",
                  "split the file into one for each segment");
    }
    layout.body_line = line_number(bytes_, layout.body);
    layout.has_names = true;
    for (std::size_t c = 0; c < titles.size(); ++c) {
      const auto title = titles[c].text;
      CsvColumn column;
      column.name = to_utf8(title);
      column.place = c;
      column.wanted = c + 1 < titles.size() || (title != "Comment" && !title.empty());
      if (title == "X_Value" || (c == 0 && title == "X")) {
        x_columns_.push_back(c);
      } else if (column.wanted) {
        values_.push_back(c);
        column.unit = header_.text("Y_Unit_Label", c);
      }
      layout.columns.push_back(std::move(column));
    }
    if (layout.body >= text.size() || values_.empty()) {
      throw error(titles_line, "the table holds no numbers", "record again");
    }
    find_csv_decimals(text, layout);
    return parse_csv_body(text, table_, options_.done_with);
  }

  Recording recording_of(std::vector<VectorXd> columns) {
    CsvLayout& layout = table_.layout;
    const auto is_empty = [&](std::size_t c) { return columns[c].array().isNaN().all(); };
    std::erase_if(x_columns_, is_empty);
    const bool has_times = !x_columns_.empty();
    // A channel without samples, of Delta_X 1, has no times.
    const auto filled = std::ranges::find_if_not(values_, is_empty);
    const std::size_t first = filled == values_.end() ? values_.front() : *filled;
    const double step = header_.number("Delta_X", first), start = header_.number("X0", first);
    const RateOfStep stated = header_.rate(first);
    const std::string delta = header_.text("Delta_X", first);
    layout.stated_rate_hz = stated.rate_hz;
    layout.rate_text = "Delta_X = " + delta;
    std::vector<std::string> others;  // their times are not those of the first
    std::erase_if(values_, [&](std::size_t c) {
      const double own = header_.number("Delta_X", c), later = header_.number("X0", c) - start;
      const auto x = std::find_if(x_columns_.rbegin(), x_columns_.rend(),
                                  [c](std::size_t k) { return k < c; });
      bool differs = own > 0 && std::abs(own / step - 1) > 1e-6;
      differs = step > 0 && !is_empty(c) && (differs || std::abs(later) > kSameTimes * step);
      if (x != x_columns_.rend() && !differs) {
        const auto apart = (columns[*x] - columns[x_columns_.front()]).array().abs();
        differs = (apart > kSameTimes * step).any();
      }
      if (differs) others.push_back(layout.columns[c].name);
      return differs;
    });
    if (!others.empty()) {
      add_note(
          table_.notes, "data_left_out", listed(others),
          "Export each rate to a file of its own: left out, sampled at other times than \"{}\" "
          "(X0, Delta_X or X values)",
          layout.columns[first].name);
    }
    if (has_times) {
      CsvColumn title = layout.columns[x_columns_.front()];
      title.name = "X_Value";
      title.unit = "s";
      table_.add(std::move(title), columns[x_columns_.front()]);
    }
    for (const std::size_t c : values_) {
      table_.add(layout.columns[c], std::move(columns[c]));
      const Channel& channel = table_.channels.back();
      const auto held = static_cast<double>(channel.samples.size() - channel.missing_samples);
      const double samples = header_.number("Samples", c);
      if (held > 0 && samples > 0 && samples != held) {
        add_note(table_.notes, "read_as", channel.name,
                 "the header states {:.0f} samples, the table holds {:.0f}",
                 std::min(samples, 1e15), held);
      }
    }
    Recording recording = recording_of_table(std::move(table_), path_, "lvm", options_);
    if (has_times) return recording;
    recording.start_time_s = start;
    if (options_.sample_rate_hz > 0) return recording;
    recording.sample_rate_relative_std = stated.relative_std;
    // 20 ppm: what ordinary loggers' clocks are off by anyhow.
    if (stated.relative_std > 2e-5) {
      add_note(recording.notes, "read_as", "",
               "Give sample_rate_hz if it is known better: Delta_X is printed as {}, so {:.9g} Hz "
               "is uncertain by {:.2g} Hz, and every frequency in proportion",
               delta, stated.rate_hz, stated.relative_std * stated.rate_hz);
    }
    return recording;
  }

  static constexpr double kSameTimes = 0.01;  // steps, as TimeAxis takes sampling as uniform
  std::string_view bytes_, rest_;
  const std::filesystem::path& path_;
  const ReadOptions& options_;
  LvmHeader header_;  // that in front of the table
  CsvTable table_;
  std::vector<std::size_t> x_columns_, values_;
};

}  // namespace

Recording read_lvm(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options) {
  return LvmReader(bytes, path, options).read();
}

}  // namespace rigfit::signal
