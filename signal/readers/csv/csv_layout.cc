#include "signal/readers/csv/csv_layout.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "signal/readers/csv/csv_fields.h"
#include "signal/readers/files/number_text.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/units.h"

namespace rigfit::signal {

namespace {

enum class CommaMeaning {
  separator,  ///< between columns
  decimal,    ///< inside the numbers of one column
  both,       ///< between columns and inside numbers: columns were split wrongly
  undecided,  ///< either reading is possible
};

/// "12", "-3", "+05"; no decimal point, no exponent.
bool is_whole(std::string_view text) {
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  return !text.empty() && text.size() < 16 && std::all_of(text.begin(), text.end(), [](char c) {
    return std::isdigit(static_cast<unsigned char>(c)) != 0;
  });
}

bool is_signed(std::string_view text) { return text.front() == '-' || text.front() == '+'; }

/// What is found behind the commas that would be decimal signs.
struct Behind {
  bool leading_zero = false;  ///< "05", or "-0" in front: no column of whole numbers is so written
  bool negative = false;      ///< no decimals are
  bool blank = false;         ///< "1, 5": a blank behind a decimal sign is not written
  bool stripped = true;       ///< no field of several digits ends with 0
  std::size_t shortest = 99, longest = 0;
};

/// The first column counts or rises in equal steps.
bool counts(const std::vector<std::vector<std::string_view>>& rows) {
  if (rows.size() < 3) return false;
  double before = 0, step = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    double value = 0;
    if (!parse_whole_number(rows[k][0], '.', value)) return false;
    if (k == 1) step = value - before;
    if (k > 0 && (value - before != step || !(step > 0))) return false;
    before = value;
  }
  return true;
}

/// `lines`: rows of the table; `titles`: the header's line above them, empty: none. A table with a
/// decimal point, or with an odd number of columns, uses its commas as separators.
CommaMeaning comma_meaning(const std::vector<std::string_view>& lines, std::string_view titles) {
  std::vector<CsvField> fields;
  std::vector<std::vector<std::string_view>> rows;
  Behind behind;
  for (const auto line : lines) {
    split_fields(line, {',', '.'}, fields);
    while (!fields.empty() && fields.back().text.empty()) fields.pop_back();
    if (fields.size() < 2 || fields.size() % 2 != 0) return CommaMeaning::separator;
    std::vector<std::string_view> row;
    for (const auto& field : fields) {
      if (field.quoted || !is_whole(field.text)) return CommaMeaning::separator;
      row.push_back(field.text);
    }
    if (!rows.empty() && row.size() != rows.front().size()) return CommaMeaning::separator;
    for (std::size_t c = 0; c + 1 < row.size(); c += 2) {
      const auto whole = row[c], part = row[c + 1];
      behind.negative |= is_signed(part);
      behind.leading_zero |= (part.size() > 1 && part.front() == '0') || whole == "-0";
      behind.blank |= part.data()[-1] != ',';
      behind.stripped &= part.size() == 1 || part.back() != '0';
      behind.shortest = std::min(behind.shortest, part.size());
      behind.longest = std::max(behind.longest, part.size());
    }
    rows.push_back(std::move(row));
  }
  if (rows.empty() || behind.negative || behind.blank) return CommaMeaning::separator;
  const std::size_t columns = rows.front().size();
  if (!titles.empty()) {
    split_fields(titles, {',', '.'}, fields);
    while (!fields.empty() && fields.back().text.empty()) fields.pop_back();
    if (fields.size() == columns) return CommaMeaning::separator;
  }
  const bool one = columns == 2;
  if (behind.leading_zero) return one ? CommaMeaning::decimal : CommaMeaning::both;
  if (one && !titles.empty() && fields.size() == 1) {
    double value = 0;
    if (!parse_whole_number(fields.front().text, '.', value)) return CommaMeaning::decimal;
  }
  if (!one || counts(rows)) return CommaMeaning::separator;
  // Decimals of different numbers of digits, one of them ending with 0, are none.
  if (behind.shortest != behind.longest && !behind.stripped) return CommaMeaning::separator;
  return CommaMeaning::undecided;
}

/// Lower case, words parted by one blank, no colon at the end, no bracketed unit.
std::string normal_label(std::string_view text) {
  std::string label = lower_case(to_utf8(text));
  for (char& c : label) {
    if (c == '_' || c == '-' || c == '.' || c == '#' || c == '%') c = ' ';
  }
  const std::size_t bracket = label.find_first_of("([{");
  if (bracket != std::string::npos) label.resize(bracket);
  std::string out;
  for (const char c : label) {
    if (c == ':' || c == '=') continue;
    if (c == ' ' && (out.empty() || out.back() == ' ')) continue;
    out += c;
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out;
}

constexpr std::string_view kUnitLabels =
    "|unit|units|eu|einheit|y unit label|channel unit|channel units|unité|eng unit|"
    "engineering units|engineering unit|unit label|";
constexpr std::string_view kNameLabels =
    "|ch name|channel name|channel names|name|names|signal|signals|label|labels|sensor|"
    "sensors|signal name|kanalname|channel|channels|";
constexpr std::string_view kNumberLabels =
    "|ch no|channel no|channel number|ch|ch number|kanal|no|";
constexpr std::string_view kRangeLabels =
    "|range|full scale|input range|messbereich|measuring range|";
constexpr std::string_view kRateLabels =
    "|sampling rate|sample rate|sampling frequency|sample frequency|samplerate|"
    "samplingrate|sampling freq|scan rate|abtastrate|abtastfrequenz|fs|"
    "samples per second|samples/s|rate|sample freq|messrate|scanrate|data rate|"
    "acquisition rate|";
constexpr std::string_view kIntervalLabels =
    "|sampling interval|sample interval|sampling period|sample period|time step|"
    "time increment|dt|delta t|delta x|interval|abtastintervall|messintervall|timestep|"
    "sampling time|sample time|time interval|delta|";

/// A row of the header as fields, trailing empty ones gone.
std::vector<CsvField> row_of(std::string_view line, const CsvDialect& dialect) {
  std::vector<CsvField> fields;
  line = trim_blanks(line);
  const CsvDialect used = dialect;
  split_fields(line, used, fields);
  if (!fields.empty() && !fields[0].text.empty()) {
    // A comment sign in front of the titles is not part of the first.
    auto& first = fields[0].text;
    if (first[0] == '#' || first[0] == '%' || first[0] == '!') {
      first.remove_prefix(1);
      first = trim_blanks(first);
      if (first.empty() && dialect.separator == ' ') fields.erase(fields.begin());
    }
  }
  while (!fields.empty() && fields.back().text.empty()) fields.pop_back();
  return fields;
}

/// Fields of titles, parted by `parted`, which is asked at each blank or sign outside brackets and
/// says how many characters end a field there (0: none).
template <typename Parted>
std::vector<CsvField> titles_by(std::string_view line, Parted&& parted) {
  std::vector<CsvField> fields;
  std::size_t first = 0;
  int depth = 0;
  const auto finish = [&](std::size_t end) {
    const auto text = trim_blanks(line.substr(first, end - first));
    if (!text.empty()) fields.push_back({text, false});
  };
  for (std::size_t at = 0; at < line.size();) {
    if (line[at] == '(' || line[at] == '[') ++depth;
    if (line[at] == ')' || line[at] == ']') depth = std::max(0, depth - 1);
    const std::size_t width = depth == 0 ? parted(line, at) : 0;
    if (width == 0) {
      ++at;
      continue;
    }
    finish(at);
    at += width;
    first = at;
  }
  finish(line.size());
  return fields;
}

std::size_t blanks_at(std::string_view line, std::size_t at) {
  std::size_t end = at;
  while (end < line.size() && (line[end] == ' ' || line[end] == '\t')) ++end;
  return end - at;
}

/// Titles above a table parted by blanks, which may hold blanks themselves: parted by tabs, by two
/// blanks or more, by a sign, or by blanks that stand before no unit in brackets, whichever gives
/// as many titles as there are columns. Empty: none does.
std::vector<CsvField> titles_with_blanks(std::string_view line, std::size_t columns) {
  line = trim_blanks(line);
  while (!line.empty() && (line[0] == '#' || line[0] == '%' || line[0] == '!')) {
    line = trim_blanks(line.substr(1));
  }
  const auto sign = [](char s) {
    return [s](std::string_view text, std::size_t at) -> std::size_t { return text[at] == s; };
  };
  const auto wide = [](std::string_view text, std::size_t at) {
    const std::size_t blanks = blanks_at(text, at);
    return blanks >= 2 ? blanks : std::size_t{0};
  };
  const auto before_no_unit = [](std::string_view text, std::size_t at) {
    const std::size_t blanks = blanks_at(text, at);
    const char next = at + blanks < text.size() ? text[at + blanks] : 'x';
    return next == '(' || next == '[' ? std::size_t{0} : blanks;
  };
  for (auto fields :
       {titles_by(line, sign('\t')), titles_by(line, wide), titles_by(line, sign(';')),
        titles_by(line, sign(',')), titles_by(line, sign('|')), titles_by(line, before_no_unit)}) {
    if (fields.size() == columns) return fields;
  }
  return {};
}

/// Titles that cannot be told apart: the time, first or last of them, is known all the same.
void name_time_only(std::string_view line, std::vector<std::string>& names) {
  const auto is_time = [](std::string_view text) {
    const std::string word = lower_case(text);
    return word == "time" || word == "t" || word == "zeit" || word == "temps";
  };
  std::vector<CsvField> words;
  split_fields(line, {' ', '.'}, words);
  while (words.size() > 1 &&
         (words.back().text.front() == '(' || words.back().text.front() == '[')) {
    words.pop_back();
  }
  if (words.empty()) return;
  if (is_time(words.front().text)) names.front() = "Time";
  if (is_time(words.back().text)) names.back() = "Time";
}

std::string unquoted(std::string_view text) {
  std::string out = to_utf8(text);
  for (std::size_t at = 0; (at = out.find("\"\"", at)) != std::string::npos; ++at) out.erase(at, 1);
  return out;
}

bool is_unit_text(std::string_view text) {
  if (parse_unit(text)) return true;
  const std::string word = lower_case(to_utf8(text));
  return word == "-" || word == "none" || word == "counts" || word == "eu" || word == "[-]" ||
         word == "(-)";
}

std::string_view trim_quotes(std::string_view text) {
  while (!text.empty() && (text.back() == ';' || text.back() == ',')) text.remove_suffix(1);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
    text = text.substr(1, text.size() - 2);
  }
  return trim_blanks(text);
}

std::string bare_unit(std::string_view text) {
  std::string unit = unquoted(text);
  if (unit.size() >= 2 && (unit.front() == '[' || unit.front() == '(') &&
      (unit.back() == ']' || unit.back() == ')')) {
    unit = std::string(trim_blanks(std::string_view(unit).substr(1, unit.size() - 2)));
  }
  return unit == "-" || lower_case(unit) == "none" ? "" : unit;
}

/// The rate of "Sampling Rate(Hz)" 50, "Sample interval [ms]" 2; 0: the label is no such thing. The
/// unit may stand in the label or behind the number.
double rate_from_label(std::string_view label, std::string_view value, char decimal) {
  const auto unquote = [](std::string_view s) {
    s = trim_blanks(s);
    while (!s.empty() && (s.front() == '"' || s.front() == '#' || s.front() == '%'))
      s.remove_prefix(1);
    while (!s.empty() && s.back() == '"') s.remove_suffix(1);
    return trim_blanks(s);
  };
  label = unquote(label);
  value = unquote(value);
  if (label.size() > 64 || value.empty()) return 0;
  const std::string plain = normal_label(label);
  const bool is_rate = is_listed(kRateLabels, plain);
  const bool is_interval = is_listed(kIntervalLabels, plain);
  if (!is_rate && !is_interval) return 0;
  std::size_t end = value.find_first_of(" \t\"");
  if (end == std::string_view::npos) end = value.size();
  std::string_view number_text = value.substr(0, end), unit_text = trim_blanks(value.substr(end));
  double number = 0;
  // "1000Hz" without a blank.
  std::size_t letters = number_text.find_first_not_of("+-.,0123456789eE");
  if (letters != std::string_view::npos && unit_text.empty()) {
    unit_text = number_text.substr(letters);
    number_text = number_text.substr(0, letters);
  }
  if (!parse_whole_number(number_text, decimal, number) &&
      !parse_whole_number(number_text, decimal == '.' ? ',' : '.', number)) {
    return 0;
  }
  if (!(number > 0) || !std::isfinite(number)) return 0;
  const std::size_t open = label.find_first_of("([");
  if (unit_text.empty() && open != std::string_view::npos) {
    unit_text = label.substr(open + 1);
    const std::size_t close = unit_text.find_first_of(")]");
    unit_text = unit_text.substr(0, close);
  }
  unit_text = trim_blanks(unit_text.substr(0, unit_text.find_first_of(",;\"")));
  double factor = 1;
  if (!unit_text.empty()) {
    const auto unit = parse_unit(unit_text);
    const std::string word = lower_case(unit_text);
    if (word == "s/s" || word == "sps" || word == "samples/s" || word == "samples/sec" ||
        word == "1/s" || word == "s-1") {
      factor = 1;
    } else if (word == "ks/s" || word == "ksps") {
      factor = 1e3;
    } else if (unit && unit->si == "Hz") {
      factor = unit->factor;
    } else if (unit && unit->quantity == Quantity::time) {
      // A unit of time tells what a label such as "sampling" left open.
      return 1 / (number * unit->factor);
    } else {
      return 0;
    }
  }
  const double rate = is_interval ? 1 / number : number * factor;
  return std::isfinite(rate) ? rate : 0;
}

void find_rate(const std::vector<std::string_view>& lines, CsvLayout& layout) {
  const CsvDialect& dialect = layout.dialect;
  for (std::size_t k = 0; k < lines.size() && layout.stated_rate_hz == 0; ++k) {
    const auto line = trim_blanks(lines[k]);
    if (line.size() > 4096) continue;
    const auto accept = [&](std::string_view label, std::string_view value) {
      const double rate = rate_from_label(label, value, dialect.decimal);
      if (!(rate > 0)) return false;
      layout.stated_rate_hz = rate;
      layout.rate_line = static_cast<long>(k) + 1;
      layout.rate_text = to_utf8(line.substr(0, 80));
      return true;
    };
    const auto fields = row_of(line, dialect);
    for (std::size_t c = 0; c + 1 < fields.size(); ++c) {
      if (accept(fields[c].text, fields[c + 1].text)) break;
    }
    if (layout.stated_rate_hz > 0) break;
    // "Sample rate: 1000 Hz", "fs = 1000" in one piece, whatever separates the columns.
    const std::size_t sign = line.find_first_of(":=\t;,");
    if (sign != std::string_view::npos) {
      auto label = line.substr(0, sign);
      auto value = line.substr(sign + 1);
      while (!value.empty() && (value.front() == ' ' || value.front() == '\t' ||
                                value.front() == '=' || value.front() == '"')) {
        value.remove_prefix(1);
      }
      if (accept(label, value)) break;
    }
    // "Sample rate 1000 Hz": a label, then its number, parted by a blank.
    for (std::size_t at = line.find(' '); at != std::string_view::npos;
         at = line.find(' ', at + 1)) {
      if (at + 1 < line.size() && std::isdigit(static_cast<unsigned char>(line[at + 1]))) {
        accept(line.substr(0, at), line.substr(at + 1));
        break;
      }
    }
  }
}

constexpr std::size_t kLongestLine = std::size_t{1} << 22;  // 4 MiB: 300,000 columns
constexpr std::size_t kSampledLines = 64;

/// Fills names, units, ranges and the stated rate of `layout`, whose dialect and columns are known.
/// Throws RecordingError when the titles show that the columns were split wrongly.
void read_csv_header(const std::vector<std::string_view>& lines, const std::string& file,
                     CsvLayout& layout) {
  const std::size_t columns = layout.columns.size();
  find_rate(lines, layout);

  std::vector<std::string> names(columns), numbers(columns), units(columns), coefficients(columns);
  std::string common_unit;
  bool have_names = false, have_units = false, have_numbers = false;
  std::size_t wide_title_fields = 0;
  long title_line = 0;
  const auto is_data_column = [&](std::size_t c) {
    return layout.columns[c].kind == ColumnKind::numbers ||
           layout.columns[c].kind == ColumnKind::clock;
  };
  const auto data_columns = static_cast<long>([&] {
    std::size_t count = 0;
    for (std::size_t c = 0; c < columns; ++c) count += is_data_column(c) ? 1 : 0;
    return count;
  }());
  const auto copy_row = [&](const std::vector<CsvField>& row, std::vector<std::string>& into,
                            std::size_t first) {
    for (std::size_t c = first; c < std::min(columns, row.size()); ++c) {
      into[c] = unquoted(row[c].text);
    }
  };

  // From the table upwards: what stands nearest counts.
  for (std::size_t k = lines.size(); k-- > 0;) {
    if (lines[k].size() > (std::size_t{1} << 22)) continue;
    auto row = row_of(lines[k], layout.dialect);
    if (row.empty()) continue;
    const bool by_blanks = layout.dialect.separator == ' ' && columns > 1;
    bool unmatched = by_blanks && row.size() != columns;
    if (unmatched) {
      auto titles = titles_with_blanks(lines[k], columns);
      if (!titles.empty()) {
        row = std::move(titles);
        unmatched = false;
      }
    }
    const std::string label = normal_label(row[0].text);
    const bool labelled = row.size() > 1;
    // "Unit;V" or "Unit: V" above a table of other columns: of all channels.
    if (const std::size_t sign = lines[k].find_first_of(";:=,\t"); sign != std::string_view::npos) {
      const auto value = trim_blanks(lines[k].substr(sign + 1));
      if (columns != 2 && is_listed(kUnitLabels, normal_label(lines[k].substr(0, sign))) &&
          is_unit_text(trim_quotes(value))) {
        if (common_unit.empty()) common_unit = bare_unit(trim_quotes(value));
        continue;
      }
    }
    if (labelled && is_listed(kUnitLabels, label)) {
      if (!have_units) {
        copy_row(row, units, 1);
        for (auto& unit : units) unit = bare_unit(unit);
        have_units = true;
      }
      continue;
    }
    if (labelled && is_listed(kRangeLabels, label)) {
      for (std::size_t c = 1; c < std::min(columns, row.size()); ++c) {
        double range = 0;
        if (parse_whole_number(row[c].text, layout.dialect.decimal, range) &&
            std::isfinite(range)) {
          layout.columns[c].range = std::abs(range);
        }
      }
      continue;
    }
    if (labelled && label == "calibration coefficient") {
      copy_row(row, coefficients, 1);
      continue;
    }
    long words = 0, unit_words = 0, filled = 0, figures = 0;
    for (std::size_t c = 0; c < std::min(columns, row.size()); ++c) {
      if (row[c].text.empty()) continue;
      const FieldKind kind = kind_of(row[c].text, layout.dialect.decimal);
      if (is_data_column(c)) {
        ++filled;
        words += kind == FieldKind::text ? 1 : 0;
        figures += kind == FieldKind::number ? 1 : 0;
        unit_words += is_unit_text(row[c].text) ? 1 : 0;
      }
    }
    const bool first_is_label =
        labelled && (is_listed(kNumberLabels, label) || is_listed(kNameLabels, label));
    // A label in front of names stands above the times: it names that column only if it is one.
    if (first_is_label && (words + figures > 1 || columns <= 2)) {
      const bool as_number = is_listed(kNumberLabels, label);
      auto& into = as_number ? numbers : names;
      bool& have = as_number ? have_numbers : have_names;
      if (!have) {
        copy_row(row, into, 1);
        have = true;
        title_line = static_cast<long>(k) + 1;
      }
      continue;
    }
    if (2 * words < data_columns || words < figures || words == 0) {
      // Fewer titles than columns: kept in mind as a sign of columns that were split wrongly.
      if (row.size() >= 1 && 2 * row.size() == columns && words == static_cast<long>(row.size()) &&
          !have_names) {
        wide_title_fields = row.size();
        title_line = static_cast<long>(k) + 1;
      }
      continue;
    }
    if (unmatched) {
      if (unit_words < filled && !have_names && layout.unmatched_titles.empty() && row.size() > 1) {
        layout.unmatched_titles = unquoted(trim_blanks(lines[k]).substr(0, 200));
        name_time_only(lines[k], names);
      }
      continue;
    }
    if (!have_units && !have_names && unit_words == filled) {
      copy_row(row, units, 0);
      for (auto& unit : units) unit = bare_unit(unit);
      have_units = true;
      title_line = static_cast<long>(k) + 1;
      continue;
    }
    if (!have_names && !have_numbers && layout.unmatched_titles.empty()) {
      if (columns >= 2 && 2 * row.size() == columns) wide_title_fields = row.size();
      copy_row(row, names, 0);
      layout.more_titles = row.size() > columns;
      have_names = true;
      title_line = static_cast<long>(k) + 1;
      // A row of units may also stand above or below; below was seen already.
    } else if (have_names && !have_units && unit_words == filled && filled > 0) {
      copy_row(row, units, 0);
      for (auto& unit : units) unit = bare_unit(unit);
      have_units = true;
    }
  }
  if (wide_title_fields > 0 && !layout.has_points && layout.dialect.separator == ',' &&
      layout.dialect.decimal == '.') {
    throw RecordingError(
        {file, title_line, 1, "", ""},
        "the table has " + std::to_string(columns) + " columns but " +
            std::to_string(wide_title_fields) +
            " titles: the comma seems to be both the separator and the decimal sign",
        "write it with semicolons between the columns, or with decimal points");
  }
  if (!have_names && !have_numbers && have_units && layout.unmatched_titles.empty()) {
    // One row only, which reads as units: it may as well be names ("s", "N").
    names = units;
    have_names = true;
  }
  for (std::size_t c = 0; c < columns; ++c) {
    // The range is that of the amplifier's input; the coefficient turns it into the unit.
    double coefficient = 0;
    if (parse_whole_number(coefficients[c], layout.dialect.decimal, coefficient) &&
        std::isfinite(coefficient)) {
      layout.columns[c].range *= std::abs(coefficient);
    }
    std::string title = names[c];
    if (title.empty() && have_numbers) title = numbers[c];
    const TitledUnit titled = split_title(title);
    layout.columns[c].name = titled.name;
    layout.columns[c].unit = have_units && !units[c].empty() ? units[c] : titled.unit;
    const bool may_be_time = c == 0 && columns > 1 && titled.name.empty();
    if (layout.columns[c].unit.empty() && !may_be_time && !is_time_name(titled.name)) {
      layout.columns[c].unit = common_unit;
    }
  }
  layout.has_names = have_names || have_numbers;
}

/// Lines all over the file: every line of a small one, else runs of lines at even distances.
std::vector<std::string_view> sample_lines(std::string_view bytes) {
  std::vector<std::string_view> sample;
  const auto take = [&](std::size_t at, std::size_t count) {
    while (count > 0 && at < bytes.size()) {
      const std::size_t end = line_end(bytes, at);
      const auto line = bytes.substr(at, end - at);
      if (!trim_blanks(line).empty() && line.size() < kLongestLine) {
        sample.push_back(line);
        --count;
      }
      at = next_line(bytes, end);
    }
  };
  constexpr std::size_t kSmall = 1 << 14;
  if (bytes.size() <= kSmall) {
    take(0, bytes.size());
    return sample;
  }
  constexpr std::size_t kRuns = 16;
  for (std::size_t run = 1; run <= kRuns; ++run) {
    const std::size_t at = bytes.size() / (kRuns + 1) * run;
    take(next_line(bytes, line_end(bytes, at)), kSampledLines / kRuns);
  }
  return sample;
}

/// Lines by what a column holds in them.
using ColumnCount = std::array<long, 5>;

long of(const ColumnCount& count, FieldKind kind) { return count[static_cast<std::size_t>(kind)]; }

struct Trial {
  CsvDialect dialect;
  long good_lines = 0;
  long numbers = 0;
  std::size_t columns = 0;
};

/// A line that can be one of the table: at least a number, and words only where there are fewer of
/// them than numbers.
bool is_good(const std::vector<CsvField>& fields, char decimal, long& numbers) {
  long words = 0;
  numbers = 0;
  for (const auto& field : fields) {
    const FieldKind kind = kind_of(field.text, decimal);
    numbers += kind == FieldKind::number ? 1 : 0;
    words += kind == FieldKind::text ? 1 : 0;
  }
  return numbers > 0 && words <= numbers;
}

Trial best_dialect(const std::vector<std::string_view>& sample, const ReadOptions& options) {
  constexpr std::array<CsvDialect, 7> kDialects = {
      {{'\t', '.'}, {'\t', ','}, {';', '.'}, {';', ','}, {',', '.'}, {' ', '.'}, {' ', ','}}};
  Trial best;
  long best_words = 0;
  std::vector<CsvField> fields;
  std::vector<Trial> trials;
  const auto consider = [&](const CsvDialect& dialect) {
    Trial trial;
    trial.dialect = dialect;
    long words = 0;
    for (const auto& line : sample) {
      split_fields(line, dialect, fields);
      long numbers = 0;
      if (!is_good(fields, dialect.decimal, numbers)) continue;
      ++trial.good_lines;
      trial.numbers += numbers;
      trial.columns = std::max(trial.columns, fields.size());
      for (const auto& field : fields) {
        words += kind_of(field.text, dialect.decimal) == FieldKind::text ? 1 : 0;
      }
    }
    // More of the text read as numbers, and less of it left as words.
    const auto worth = [](const Trial& t, long w) { return t.numbers - 2 * w; };
    if (trial.good_lines > best.good_lines ||
        (trial.good_lines == best.good_lines && worth(trial, words) > worth(best, best_words))) {
      best = trial;
      best_words = words;
    }
  };
  const auto allowed = [&](const CsvDialect& dialect) {
    return (options.separator == 0 || dialect.separator == options.separator) &&
           (options.decimal == 0 || dialect.decimal == options.decimal);
  };
  for (const auto& dialect : kDialects) {
    if (allowed(dialect)) consider(dialect);
  }
  // "1,5","2,5": a comma inside quotes is the decimal sign of a table separated by commas.
  const bool quotes = std::any_of(sample.begin(), sample.end(), [](const auto& line) {
    return line.find('"') != std::string_view::npos;
  });
  if (quotes && allowed({',', ','})) consider({',', ','});
  return best;
}

/// The table of commas again, where these are decimal signs or may be.
void decide_commas(const std::vector<std::string_view>& sample, std::size_t columns,
                   const std::vector<std::string_view>& header, const std::string& file,
                   CsvDialect& dialect) {
  std::vector<std::string_view> rows;
  std::vector<CsvField> fields;
  for (const auto& line : sample) {
    long numbers = 0;
    split_fields(line, dialect, fields);
    if (is_good(fields, dialect.decimal, numbers) && fields.size() <= columns) rows.push_back(line);
  }
  std::string_view titles;
  for (const auto& line : header) {
    if (!trim_blanks(line).empty()) titles = line;
  }
  switch (comma_meaning(rows, titles)) {
    case CommaMeaning::separator:
      return;
    case CommaMeaning::decimal:
      dialect = {';', ','};
      return;
    case CommaMeaning::both:
      throw RecordingError(
          {file, static_cast<long>(header.size()) + 1, 1, "", to_utf8(rows.front().substr(0, 60))},
          "the comma seems to be both the separator and the decimal sign",
          "write it with semicolons between the columns, or with decimal points");
    case CommaMeaning::undecided:
      throw RecordingError(
          {file, static_cast<long>(header.size()) + 1, 1, "", to_utf8(rows.front().substr(0, 60))},
          "may be one column with decimal commas or two columns of whole numbers",
          "say it: --decimal comma or --separator comma (keys decimal, separator of the TOML file "
          "beside it)");
  }
}

}  // namespace

std::size_t line_end(std::string_view bytes, std::size_t from) {
  // Both signs are looked for in pieces: in a file that has only one of them the search for the
  // other would run to the end of the file for every line.
  std::size_t piece = 256;
  while (from < bytes.size()) {
    const auto window = bytes.substr(from, piece);
    const std::size_t lf = window.find('\n');
    const std::size_t cr = window.substr(0, lf).find('\r');
    if (cr != std::string_view::npos) return from + cr;
    if (lf != std::string_view::npos) return from + lf;
    from += window.size();
    piece = std::min<std::size_t>(2 * piece, 1 << 16);
  }
  return bytes.size();
}

std::size_t next_line(std::string_view bytes, std::size_t end) {
  if (end >= bytes.size()) return bytes.size();
  if (bytes[end] == '\r' && end + 1 < bytes.size() && bytes[end + 1] == '\n') return end + 2;
  return end + 1;
}

long line_number(std::string_view bytes, std::size_t offset) {
  long line = 1;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t next = next_line(bytes, line_end(bytes, at));
    if (next > offset || next >= bytes.size()) break;
    at = next;
    ++line;
  }
  return line;
}

CsvLayout find_csv_layout(std::string_view bytes, const std::string& file,
                          const ReadOptions& options) {
  const auto no_table = [&](const std::string& why) {
    return RecordingError({file, 1, 1, "", ""}, why,
                          "give a table with one line a sample, columns separated by comma, "
                          "semicolon, tab or blanks");
  };
  const std::vector<std::string_view> sample = sample_lines(bytes);
  if (sample.empty()) throw no_table("no lines of text of a usual length");
  const Trial trial = best_dialect(sample, options);
  if (trial.good_lines == 0) throw no_table("no table of numbers in this text");

  CsvLayout layout;
  layout.dialect = trial.dialect;
  std::vector<CsvField> fields;
  std::vector<ColumnCount> counts(trial.columns);
  long good = 0;
  for (const auto& line : sample) {
    split_fields(line, layout.dialect, fields);
    long numbers = 0;
    if (!is_good(fields, layout.dialect.decimal, numbers)) continue;
    ++good;
    for (const auto& field : fields) {
      layout.has_points |= kind_of(field.text, '.') == FieldKind::number &&
                           field.text.find('.') != std::string_view::npos;
    }
    for (std::size_t c = 0; c < counts.size(); ++c) {
      ++counts[c][static_cast<std::size_t>(
          c < fields.size() ? kind_of(fields[c].text, layout.dialect.decimal) : FieldKind::empty)];
    }
  }
  layout.columns.resize(counts.size());
  for (std::size_t c = 0; c < counts.size(); ++c) {
    const ColumnCount& count = counts[c];
    ColumnKind& kind = layout.columns[c].kind;
    const long some = of(count, FieldKind::number) + of(count, FieldKind::missing);
    const long clock = of(count, FieldKind::clock), text = of(count, FieldKind::text);
    layout.columns[c].filled = static_cast<double>(some) / static_cast<double>(good);
    if (clock > some && clock >= text) {
      kind = ColumnKind::clock;
    } else if (2 * some >= good || (some > 0 && some >= text && 10 * text <= good)) {
      kind = some == 0 ? ColumnKind::empty : ColumnKind::numbers;
      if (2 * some < good && text > 0) kind = ColumnKind::text;
    } else {
      kind = text > 0 ? ColumnKind::text : ColumnKind::empty;
    }
  }

  const auto is_body = [&](std::string_view line) {
    split_fields(line, layout.dialect, fields);
    long numbers = 0, columns = 0;
    for (std::size_t c = 0; c < fields.size(); ++c) {
      const FieldKind kind = kind_of(fields[c].text, layout.dialect.decimal);
      if (c >= layout.columns.size()) {
        if (kind != FieldKind::empty) return false;
        continue;
      }
      const ColumnKind expected = layout.columns[c].kind;
      if (expected == ColumnKind::numbers) {
        if (kind == FieldKind::text || kind == FieldKind::clock) return false;
        numbers += kind == FieldKind::number ? 1 : 0;
      } else if (expected == ColumnKind::clock) {
        if (kind != FieldKind::clock) return false;
      } else if (expected == ColumnKind::empty && c == 0 && kind != FieldKind::empty) {
        return false;
      }
    }
    for (const auto& column : layout.columns) columns += column.kind == ColumnKind::numbers ? 1 : 0;
    return 2 * numbers >= columns && numbers > 0;
  };
  // A line of more words than numbers belongs to a header; one with a wrong field does not.
  const auto is_title = [&](std::string_view line) {
    split_fields(line, layout.dialect, fields);
    long words = 0, numbers = 0;
    for (const auto& field : fields) {
      const FieldKind kind = kind_of(field.text, layout.dialect.decimal);
      words += kind == FieldKind::text ? 1 : 0;
      numbers += kind == FieldKind::number ? 1 : 0;
    }
    return words > numbers;
  };
  // The table begins at the first of three lines of numbers with no line of words between. Lines of
  // numbers above such a line are part of the header.
  std::vector<std::string_view> header;
  std::size_t begin = 0, header_size = 0;
  int rows = 0;
  for (std::size_t at = 0; at < bytes.size() && rows < 3;) {
    const std::size_t end = line_end(bytes, at);
    const auto line = bytes.substr(at, end - at);
    if (line.size() >= kLongestLine || is_title(line)) {
      if (rows > 0 && next_line(bytes, end) >= bytes.size()) break;  // a word behind a short table
      rows = 0;
    } else if (is_body(line) && rows++ == 0) {
      begin = at;
      header_size = header.size();
    }
    header.push_back(line);
    at = next_line(bytes, end);
  }
  if (rows == 0) throw no_table("no lines of numbers that follow each other");
  header.resize(header_size);
  layout.body = begin;
  layout.body_line = static_cast<long>(header_size) + 1;
  if (layout.dialect.separator == ',' && layout.dialect.decimal == '.' && options.decimal == 0 &&
      options.separator == 0) {
    decide_commas(sample, layout.columns.size(), header, file, layout.dialect);
    if (layout.dialect.separator != ',') {
      ReadOptions decided;
      decided.separator = layout.dialect.separator;
      decided.decimal = layout.dialect.decimal;
      return find_csv_layout(bytes, file, decided);
    }
  }
  for (const auto& line : header) {
    if (layout.heading.size() < 4096) layout.heading += lower_case(to_utf8(line)) + '\n';
  }
  read_csv_header(header, file, layout);
  return layout;
}

bool is_time_name(const std::string& name) {
  const std::string word = lower_case(name);
  static constexpr std::string_view kWords =
      "|t|time|zeit|temps|tiempo|tempo|tid|sec|secs|second|seconds|s|ms|msec|elapsed|"
      "timestamp|clock|uhrzeit|datetime|date/time|date time|x_value|x value|time_s|"
      "elapsed time|t_s|relative time|time stamp|rel time|time_ms|";
  if (is_listed(kWords, word)) return true;
  for (const std::string_view stem : {"time", "zeit", "elapsed", "timestamp"}) {
    if (word.size() > stem.size() && word.compare(0, stem.size(), stem) == 0 &&
        std::isalpha(static_cast<unsigned char>(word[stem.size()])) == 0) {
      return true;
    }
  }
  return word.size() > 5 && word.compare(word.size() - 5, 5, " time") == 0;
}

}  // namespace rigfit::signal
