#include "signal/readers/csv/csv_header.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "signal/readers/files/number_text.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

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

template <std::size_t N>
bool is_one_of(const std::string& label, const std::array<std::string_view, N>& words) {
  return std::find(words.begin(), words.end(), label) != words.end();
}

constexpr std::array<std::string_view, 12> kUnitLabels = {
    "unit",          "units", "eu",       "einheit",           "y unit label",     "channel unit",
    "channel units", "unité", "eng unit", "engineering units", "engineering unit", "unit label"};
constexpr std::array<std::string_view, 15> kNameLabels = {
    "ch name", "channel name", "channel names", "name",    "names",
    "signal",  "signals",      "label",         "labels",  "sensor",
    "sensors", "signal name",  "kanalname",     "channel", "channels"};
constexpr std::array<std::string_view, 7> kNumberLabels = {
    "ch no", "channel no", "channel number", "ch", "ch number", "kanal", "no"};
constexpr std::array<std::string_view, 5> kRangeLabels = {"range", "full scale", "input range",
                                                          "messbereich", "measuring range"};
constexpr std::array<std::string_view, 19> kRateLabels = {
    "sampling rate",    "sample rate", "sampling frequency",
    "sample frequency", "samplerate",  "samplingrate",
    "sampling freq",    "scan rate",   "abtastrate",
    "abtastfrequenz",   "fs",          "samples per second",
    "samples/s",        "rate",        "sample freq",
    "messrate",         "scanrate",    "data rate",
    "acquisition rate"};
constexpr std::array<std::string_view, 17> kIntervalLabels = {"sampling interval",
                                                              "sample interval",
                                                              "sampling period",
                                                              "sample period",
                                                              "time step",
                                                              "time increment",
                                                              "dt",
                                                              "delta t",
                                                              "delta x",
                                                              "interval",
                                                              "abtastintervall",
                                                              "messintervall",
                                                              "timestep",
                                                              "sampling time",
                                                              "sample time",
                                                              "time interval",
                                                              "delta"};

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

std::string bare_unit(std::string_view text) {
  std::string unit = unquoted(text);
  if (unit.size() >= 2 && (unit.front() == '[' || unit.front() == '(') &&
      (unit.back() == ']' || unit.back() == ')')) {
    unit = std::string(trim_blanks(std::string_view(unit).substr(1, unit.size() - 2)));
  }
  return unit == "-" || lower_case(unit) == "none" ? "" : unit;
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

}  // namespace

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
  const bool is_rate = is_one_of(plain, kRateLabels);
  const bool is_interval = is_one_of(plain, kIntervalLabels);
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

void read_csv_header(const std::vector<std::string_view>& lines, const std::string& file,
                     CsvLayout& layout) {
  const std::size_t columns = layout.columns.size();
  find_rate(lines, layout);

  std::vector<std::string> names(columns), numbers(columns), units(columns), coefficients(columns);
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
    if (labelled && is_one_of(label, kUnitLabels)) {
      if (!have_units) {
        copy_row(row, units, 1);
        for (auto& unit : units) unit = bare_unit(unit);
        have_units = true;
      }
      continue;
    }
    if (labelled && is_one_of(label, kRangeLabels)) {
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
        labelled && (is_one_of(label, kNumberLabels) || is_one_of(label, kNameLabels));
    // A label in front of names stands above the times: it names that column only if it is one.
    if (first_is_label && (words + figures > 1 || columns <= 2)) {
      const bool as_number = is_one_of(label, kNumberLabels);
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
      // Titles further right than the table's columns are reported by the caller's column count.
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
  }
  layout.has_names = have_names || have_numbers;
}

}  // namespace rigfit::signal
