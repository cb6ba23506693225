// The lines above a table: names, units and ranges of its columns, and the rate that they state.
#include <fmt/format.h>

#include <regex>

#include "signal/readers/csv_table.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {
namespace {

using Fields = std::vector<CsvField>;
using Row = CsvRow;

constexpr std::size_t kLongestMatched = 4096;  // std::regex takes some stack for each character

bool is_bracketed(std::string_view text) {
  return text.size() > 2 && ((text.front() == '[' && text.back() == ']') ||
                             (text.front() == '(' && text.back() == ')'));
}

/// Lower case, words parted by one blank, no colon at the end, no bracketed unit.
std::string normal_label(std::string_view text) {
  static const std::regex kNoWord(R"([(\[{].*|[:=])"), kBetween("[-_.#% ]+");
  std::string label = lower_case(to_utf8(text.substr(0, kLongestMatched)));
  label = std::regex_replace(std::regex_replace(label, kNoWord, ""), kBetween, " ");
  return std::string(trim_blanks(label));
}

// Without their blanks.
constexpr std::string_view kRateLabels =
    "|samplingrate|samplerate|samplingfrequency|samplefrequency|samplingfreq|scanrate|abtastrate|"
    "abtastfrequenz|fs|samplespersecond|samples/s|rate|samplefreq|messrate|datarate|"
    "acquisitionrate|fsamp|numberofsamplespersecond|fsample|freqsamp|fsampling|srate|";
constexpr std::string_view kIntervalLabels =
    "|samplinginterval|sampleinterval|samplingperiod|sampleperiod|timestep|timeincrement|dt|deltat|"
    "deltax|interval|abtastintervall|messintervall|samplingtime|sampletime|timeinterval|delta|"
    "increment|xaxisdelta|samplingintervals|tsample|tinterval|";

/// What a row of the header gives for each column.
enum RowUse : std::size_t { kUnits, kRanges, kCoefficients, kNumbers, kNames, kUses };
/// The labels in front of rows, by their use.
constexpr std::array<std::string_view, kUses> kRowLabels = {
    "|unit|units|eu|einheit|y unit label|channel unit|channel units|unité|eng unit|"
    "engineering units|engineering unit|unit label|vertical units|y axis unit|sequence|ts|",
    "|range|full scale|input range|messbereich|measuring range|", "|calibration coefficient|",
    "|ch no|channel no|channel number|ch|ch number|kanal|no|",
    "|ch name|channel name|channel names|name|names|signal|signals|label|labels|sensor|"
    "sensors|signal name|kanalname|channel|channels|headers|"};

bool is_comment_sign(char c) { return std::string_view("#%!;*").find(c) != std::string_view::npos; }

/// Titles above a table parted by blanks, which may hold blanks themselves: parted by tabs, by two
/// blanks or more, by a sign, or by blanks that stand before no unit in brackets, whichever gives
/// as many titles as there are columns. Empty: none does.
Fields titles_with_blanks(std::string_view line, std::size_t columns) {
  line = trim_blanks(line);
  while (!line.empty() && is_comment_sign(line[0])) line = trim_blanks(line.substr(1));
  if (line.size() > kLongestMatched) return {};
  for (const char* between : {"\t+", "[ \t]{2,}", ";", ",", "\\|", "[ \t]+(?![(\\[ \t])"}) {
    Fields fields;
    const std::regex parts(between);
    std::cregex_token_iterator one(line.data(), line.data() + line.size(), parts, -1), last;
    for (; one != last; ++one) {
      const auto length = static_cast<std::size_t>(one->length());
      const auto text = trim_blanks({length > 0 ? &*one->first : "", length});
      if (!text.empty()) fields.push_back({text, false});
    }
    if (fields.size() == columns) return fields;
  }
  return {};
}

std::string unquoted(std::string_view text) {
  std::string out = to_utf8(text);
  for (std::size_t at = 0; (at = out.find("\"\"", at)) != std::string::npos; ++at) out.erase(at, 1);
  return out;
}

std::string bare_unit(std::string_view text) {
  std::string unit = unquoted(text);
  if (is_bracketed(unit)) {
    unit = std::string(trim_blanks(std::string_view(unit).substr(1, unit.size() - 2)));
  }
  return unit == "-" || lower_case(unit) == "none" ? "" : unit;
}

/// The rate that lines of the header state, as "Sampling Rate(Hz)" 50, "Sample interval [ms]" 2 or
/// "fs = 1 kHz": a label, a unit in brackets or none, behind a sign or a blank a number, its unit
/// or none. Throws where two of them differ.
void find_rate(const std::vector<std::string_view>& lines, const std::string& file, bool is_given,
               CsvLayout& layout) {
  static const std::regex kStated(
      R"((?:^|[\t;,:="#%])\s*([a-z][^\t;,:="#%0-9([]*?)\s*(?:[([]([^)\]]*)[)\]])?)"  // label, unit
      R"((["\s:;,=#%]+)((?:\d+(?:\.\d*|,\d+)?|[.,]\d+)(?:e[+-]?\d+)?)(?![.\d]|\s\d{3}))"  // number
      R"(\s*([^\s;,"0-9][^;,"]*)?)",                                                      // unit
      std::regex::icase);
  const auto take = [&](double rate, std::size_t k) {
    if (rate == 0) return;
    const std::string text = to_utf8(lines[k].substr(0, 80));
    const auto line = static_cast<long>(k) + 1;
    if (layout.stated_rate_hz == 0) {
      layout.stated_rate_hz = rate;
      layout.rate_line = line;
      layout.rate_text = text;
    } else if (!is_given && std::abs(rate / layout.stated_rate_hz - 1) > 1e-2) {
      throw RecordingError({file, line, 0, "", text},
                           fmt::format("gives {:.9g} Hz, but \"{}\" gives {:.9g} Hz", rate,
                                       layout.rate_text, layout.stated_rate_hz),
                           "correct the header, or give the sample rate: --sample-rate");
    }
  };
  for (std::size_t k = 0; k < lines.size(); ++k) {
    // "Increment" above its number.
    const auto line_at = [&](std::size_t at) { return lines[at].substr(0, kLongestMatched); };
    const Row labels(line_at(k), layout.dialect);
    const Row below(line_at(std::min(k + 1, lines.size() - 1)), layout.dialect);
    for (std::size_t c = 0; c < std::min(labels.fields.size(), below.fields.size()); ++c) {
      double step = 0;
      if (labels.kinds[c] != FieldKind::text ||
          !parse_whole_number(below.fields[c].text, layout.dialect.decimal, step)) {
        continue;
      }
      take(rate_of_label(std::string(labels.fields[c].text), step, ""), k + 1);
    }
    const std::string line(line_at(k));
    for (std::sregex_iterator one(line.begin(), line.end(), kStated), end; one != end; ++one) {
      const std::smatch& match = *one;
      double value = 0;
      const std::string between = match[3], unit = match[match[5].length() > 0 ? 5 : 2];
      std::string digits = match[4];
      // A comma is a decimal sign unless it parts the fields of this line.
      if (layout.dialect.separator == ',' && between.find(',') != std::string::npos) {
        digits.resize(std::min(digits.find(','), digits.size()));
      }
      // The sign that is not the table's and stands before three digits parts thousands.
      const char thousands = layout.dialect.decimal == '.' ? ',' : '.';
      if (digits.size() > 4 && digits[0] != '0' && digits[digits.size() - 4] == thousands) {
        digits.erase(digits.size() - 4, 1);
      }
      if (!parse_whole_number(digits, '.', value) && !parse_whole_number(digits, ',', value)) {
        continue;
      }
      take(rate_of_label(match[1], value, std::string(trim_blanks(unit))), k);
    }
  }
}

/// Reads names, units and ranges of the columns from the lines above the table.
class HeaderReader {
 public:
  explicit HeaderReader(CsvLayout& layout) : layout_(layout), columns_(layout.columns.size()) {
    for (auto& texts : given_) texts.resize(columns_);
  }

  void read(const std::vector<std::string_view>& lines) {
    // From the table upwards: what stands nearest counts.
    for (std::size_t k = lines.size(); k-- > 0;) read_line(lines[k], k > 0 ? lines[k - 1] : "");
    fill_columns();
  }

 private:
  void copy(const Fields& row, std::size_t first, RowUse use) {
    if (have_[use]) return;
    have_[use] = true;
    if (use == kNames || use == kNumbers) titles_ = std::max(titles_, fields_);
    for (std::size_t c = first; c < std::min(columns_, row.size()); ++c) {
      given_[use][c] = use == kUnits ? bare_unit(row[c].text) : unquoted(row[c].text);
    }
  }

  /// Fields of a line without a comment sign in front; titles that hold blanks are not parted.
  Fields fields_of(std::string_view line) const {
    Fields row = Row(trim_blanks(line), layout_.dialect).fields;
    const bool by_blanks = layout_.dialect.separator == ' ';
    if (!row.empty() && row[0].text.size() > (by_blanks ? 0 : 1) &&
        is_comment_sign(row[0].text[0])) {
      // The sign is not part of the first title; "%" alone is a unit.
      row[0].text = trim_blanks(row[0].text.substr(1));
      if (row[0].text.empty()) row.erase(row.begin());
    }
    if (!by_blanks || columns_ < 2 || row.size() == columns_) return row;
    Fields titles = titles_with_blanks(line, columns_);
    return titles.empty() ? row : titles;
  }

  /// What stands above the columns of data.
  struct Counts {
    long words = 0, figures = 0, units = 0, filled = 0, numbered = 0;
  };
  Counts counts_of(const Fields& row) const {
    Counts n;
    for (std::size_t c = 0; c < std::min(columns_, row.size()); ++c) {
      if (!layout_.columns[c].has_data() || row[c].text.empty()) continue;
      const FieldKind kind = kind_of(row[c].text, layout_.dialect.decimal);
      ++n.filled;
      n.words += kind == FieldKind::text ? 1 : 0;
      n.figures += kind == FieldKind::number ? 1 : 0;
      n.numbered += row[c].text == std::to_string(n.numbered + 1) ? 1 : 0;
      n.units += is_unit_text(row[c].text) ? 1 : 0;
    }
    return n;
  }

  void read_line(std::string_view line, std::string_view above) {
    Fields row = fields_of(line);
    fields_ = row.size();
    row = without_empty_end(std::move(row));
    if (row.empty()) return;
    const bool by_blanks = layout_.dialect.separator == ' ';
    const bool unmatched = by_blanks && columns_ > 1 && row.size() != columns_;
    // "Unit;V" or "Unit: V" above a table of other columns: of all channels.
    static const std::regex kCommon(R"(([^;:=,\t]*)[;:=,\t]\t*([^;,\t]*)[;,\t]*)");
    const std::string text(trim_blanks(line.substr(0, kLongestMatched)));
    std::smatch common;
    if (columns_ != 2 && std::regex_match(text, common, kCommon)) {
      std::string value = common[2];
      std::erase(value, '"');
      value = trim_blanks(value);
      if (is_listed(kRowLabels[kUnits], normal_label(common[1].str())) &&
          (!by_blanks || value.find(' ') == value.npos) && is_unit_text(value)) {
        if (common_unit_.empty()) common_unit_ = bare_unit(value);
        return;
      }
    }
    const Counts here = counts_of(row);
    const long data_columns = std::ranges::count_if(layout_.columns, &CsvColumn::has_data);
    const std::string label = row.size() > 1 ? normal_label(row[0].text) : "";
    for (const RowUse use : {kUnits, kRanges, kCoefficients, kNumbers, kNames}) {
      // A label in front of names stands above the times: it names that column only if it is one.
      const bool titles = use == kNumbers || use == kNames;
      if (label.empty() || !is_listed(kRowLabels[use], label) ||
          (titles && here.words + here.figures <= 1 && columns_ > 2) ||
          (is_listed("|sequence|ts|", label) && here.units == 0) ||
          (label == "no" && here.figures == 0)) {
        continue;
      }
      // ";Headers, time, Ax": a label beside as many names as there are columns.
      const bool beside = titles && row.size() == columns_ + 1;
      if (beside) row.erase(row.begin());
      return copy(row, beside ? 0 : 1, use);
    }
    // A line without a label: titles, or units where every field is one, or most are and names
    // stand above. Numbers are names where they count the channels: "x-axis,1,2" above units.
    const bool counted = have_[kUnits] && here.words == 1 && here.numbered == data_columns - 1;
    if (!counted && (2 * here.words < data_columns || here.words < here.figures || here.words == 0))
      return;
    // "Y-Axis Unit: m" is no row of titles.
    const auto is_label = [](const CsvField& field) {
      return field.text.ends_with(':') || field.text.ends_with('=');
    };
    if (row.size() > 1 && is_label(row[0]) && !is_label(row[1])) return;
    if (columns_ == 1 && line.find('=') != line.npos) return;  // "NPTS= 3164, DT= .0050 SEC"
    const bool untitled = !have_[kNames] && layout_.unmatched_titles.empty();
    bool only_units = here.units == here.filled;
    if (untitled && 2 * here.units >= here.filled) {
      const Counts titles = counts_of(fields_of(above));
      only_units |= titles.words == data_columns && titles.units < here.units;
    }
    if (unmatched) {
      if (!only_units && untitled && row.size() > 1) {
        layout_.unmatched_titles = unquoted(trim_blanks(line).substr(0, 200));
      }
    } else if (only_units && !have_[kUnits]) {
      copy(row, 0, kUnits);
    } else if ((untitled || same_names_) && !have_[kNumbers]) {
      // "Smp", "Smp" tells columns apart only where no row above does.
      std::set<std::string_view> names;
      for (std::size_t c = 0; c < std::min(columns_, row.size()); ++c) {
        if (layout_.columns[c].has_data() && !row[c].text.empty()) names.insert(row[c].text);
      }
      const bool same = std::ssize(names) < here.filled;
      if (!untitled && (same || here.filled < data_columns)) return;
      layout_.more_titles = row.size() > columns_;
      same_names_ = same && line.find_first_of("([") == line.npos;
      have_[kNames] = false;
      copy(row, 0, kNames);
    }
  }

  void fill_columns() {
    if (!have_[kNames] && !have_[kNumbers] && have_[kUnits] && layout_.unmatched_titles.empty()) {
      // One row only, which reads as units: it may as well be names ("s", "N").
      given_[kNames] = given_[kUnits];
      have_[kNames] = true;
    }
    const auto number = [&](RowUse use, std::size_t c, double otherwise) {
      double value = 0;
      const bool is_number = parse_whole_number(given_[use][c], layout_.dialect.decimal, value);
      return is_number && std::isfinite(value) ? std::abs(value) : otherwise;
    };
    for (std::size_t c = 0; c < columns_; ++c) {
      CsvColumn& column = layout_.columns[c];
      // The range is that of the amplifier's input; the coefficient turns it into the unit.
      column.range = number(kRanges, c, 0) * number(kCoefficients, c, 1);
      auto [name, unit] = split_title(given_[given_[kNames][c].empty() ? kNumbers : kNames][c]);
      const bool may_be_time = c == 0 && columns_ > 1 && name.empty();
      const bool takes_common = !may_be_time && !is_time_name(name);
      if (!given_[kUnits][c].empty()) unit = given_[kUnits][c];
      if (unit.empty() && is_time_name(name)) {  // "millis" and "ms" name their unit
        const auto parsed = parse_unit(name);
        if (parsed && parsed->quantity == Quantity::time) unit = name;
      }
      column.unit = unit.empty() && takes_common ? common_unit_ : unit;
      column.name = std::move(name);
    }
    layout_.has_names = have_[kNames] || have_[kNumbers];
    // What now and then stands behind the last title is no column: the lines are refused.
    while (titles_ > 0 && layout_.columns.size() > titles_ && layout_.columns.back().filled < 0.5) {
      layout_.columns.pop_back();
    }
  }

  CsvLayout& layout_;
  const std::size_t columns_;
  std::array<bool, kUses> have_{};
  std::array<std::vector<std::string>, kUses> given_;
  std::string common_unit_;
  bool same_names_ = false;
  std::size_t fields_ = 0, titles_ = 0;  ///< of this line; of the widest line of titles
};

/// Refuses a line of the header whose last quote is not closed: the title's line breaks there.
void refuse_broken_titles(std::string_view bytes, const std::string& file,
                          const std::vector<std::string_view>& header, const CsvDialect& dialect) {
  Fields fields;
  for (const auto line : header) {
    split_fields(line, dialect, fields);
    if (fields.empty() || fields.back().quoted || !fields.back().text.starts_with('"')) continue;
    throw text_error(bytes, file, fields.back().text, "a quote that is not closed in its line",
                     "write each title in one line");
  }
}

}  // namespace

bool is_unit_text(std::string_view text) {
  constexpr std::string_view kOthers =
      "|-|none|count|counts|eu|cycles|a|ma|ohm|w|db|dba|l/min|gpm|";
  return is_bracketed(text) || parse_unit(text) || is_listed(kOthers, lower_case(to_utf8(text)));
}

void read_csv_header(const std::vector<std::string_view>& lines, std::string_view bytes,
                     const std::string& file, const ReadOptions& options, CsvLayout& layout) {
  find_rate(lines, file, options.sample_rate_hz > 0, layout);
  refuse_broken_titles(bytes, file, lines, layout.dialect);
  HeaderReader(layout).read(lines);
}

double rate_of_label(const std::string& text, double number, const std::string& unit_text) {
  std::string label = normal_label(text);
  if (label.size() > 3) std::erase(label, ' ');  // "F.S." is full scale, no sample rate
  const bool is_interval = is_listed(kIntervalLabels, label);
  if (!is_interval && !is_listed(kRateLabels, label)) return 0;
  const auto unit = parse_unit(unit_text);
  const std::string word = lower_case(unit_text);
  // A unit of time tells what a label such as "sampling" left open.
  double rate = is_interval ? 1 / number : number;
  if (is_listed("|ks/s|ksps|", word)) {
    rate = 1e3 * number;
  } else if (unit && unit->quantity == Quantity::time) {
    rate = 1 / (number * unit->factor);
  } else if (unit && unit->si == "Hz") {
    rate = is_interval ? rate : number * unit->factor;
  } else if (!is_listed("||s/s|sps|samples/s|samples/sec|", word)) {
    return 0;
  }
  return rate > 0 && std::isfinite(rate) ? rate : 0;
}

bool is_time_name(const std::string& name) {
  const std::string word = lower_case(name);
  static constexpr std::string_view kWords =
      "|t|time|zeit|temps|tiempo|tempo|tid|sec|secs|second|seconds|s|ms|us|\u00B5s|msec|elapsed|"
      "timestamp|clock|uhrzeit|datetime|date/time|date time|x_value|x value|time_s|"
      "elapsed time|t_s|relative time|time stamp|rel time|time_ms|millis|micros|milliseconds|"
      "microseconds|";
  static const std::regex kBeginning("^(time|zeit|elapsed|timestamp)[^a-z]");
  return std::regex_search(word.substr(0, 16), kBeginning) || is_listed(kWords, word) ||
         word.ends_with(" time");
}

}  // namespace rigfit::signal
