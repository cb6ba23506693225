#include "signal/readers/csv_fields.h"

#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>

namespace rigfit::signal {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

bool is_digit(char c) { return static_cast<unsigned char>(c - '0') < 10; }

/// Unsigned decimal digits at `at`, at most `most` of them; -1 when there are none.
int digits_at(std::string_view s, std::size_t& at, std::size_t most) {
  int value = -1;
  for (std::size_t last = at + most; at < std::min(last, s.size()) && is_digit(s[at]); ++at) {
    value = std::max(value, 0) * 10 + (s[at] - '0');
  }
  return value;
}

}  // namespace

std::size_t parse_number(std::string_view text, char decimal, double& value) {
  const bool is_negative = text.starts_with('-');
  // Also with blanks behind the sign: "+    1.00".
  const std::size_t begin = is_negative || text.starts_with('+')
                                ? std::min(text.find_first_not_of(' ', 1), text.size())
                                : 0;
  // std::from_chars takes "inf" and "nan", too.
  if (begin >= text.size() || (!is_digit(text[begin]) && text[begin] != decimal)) return 0;
  const auto read = [&](std::string_view number) {
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    const auto length = static_cast<std::size_t>(end - number.data());
    // from_chars does not say whether the number is too large or too small; strtod does.
    if (error == std::errc::result_out_of_range) {
      value = std::strtod(std::string(number.substr(0, length)).c_str(), nullptr);
    }
    if (is_negative) value = -value;
    return error == std::errc::invalid_argument ? 0 : begin + length;
  };
  text.remove_prefix(begin);
  if (decimal == '.') {
    const std::size_t length = read(text);
    const std::size_t behind = length - begin;
    if (length == 0 || behind >= text.size() || (text[behind] | 0x20) != 'd') return length;
  }
  std::string copy;
  for (const char c : text) {
    if (!is_digit(c) && c != decimal && !std::strchr("+-eEdD", c)) break;
    copy += c == decimal ? '.' : c == 'd' || c == 'D' ? 'e' : c;
  }
  return read(copy);
}

bool parse_whole_number(std::string_view text, char decimal, double& value) {
  const std::size_t length = parse_number(text, decimal, value), point = text.find(decimal);
  if (length == 0 || length == text.size()) return length > 0;
  // "1,234.5": signs before groups of three digits, where the decimal sign follows.
  if (point == text.npos || point < length || (point - length) % 4 != 0) return false;
  const std::string_view signs = decimal == '.' ? ",' " : ".' ";
  std::string joined(text.substr(0, length));
  for (std::size_t at = length; at < point; at += 4) {
    if (signs.find(text[at]) == signs.npos) return false;
    joined += text.substr(at + 1, 3);
  }
  joined += text.substr(point);
  return parse_number(joined, decimal, value) == joined.size();
}

int printed_decimals(std::string_view text, char decimal) {
  const std::size_t end = std::min(text.find_first_of("eEdD"), text.size());
  const std::size_t sign = std::min(text.find(decimal), end);
  std::string_view power = text.substr(std::min(end + 1, text.size()));
  if (power.starts_with('+')) power.remove_prefix(1);
  int exponent = 0;
  std::from_chars(power.data(), power.data() + power.size(), exponent);
  return (sign < end ? static_cast<int>(end - sign) - 1 : 0) - std::clamp(exponent, -400, 400);
}

void split_fields(std::string_view line, const CsvDialect& dialect, std::vector<CsvField>& fields) {
  fields.clear();
  const bool by_blanks = dialect.separator == ' ';
  const auto ends_field = [&](char c) { return by_blanks ? is_blank(c) : c == dialect.separator; };
  for (std::size_t at = 0;; ++at) {
    while (at < line.size() && is_blank(line[at]) && (by_blanks || !ends_field(line[at]))) ++at;
    if (by_blanks && at >= line.size()) return;
    const std::size_t first = at;
    std::size_t end = at + 1;
    bool quoted = at < line.size() && line[at] == '"';
    if (quoted) {
      while (end < line.size() && (line[end] != '"' || line.substr(end, 2) == "\"\"")) {
        end += line[end] == '"' ? 2 : 1;
      }
      quoted = end < line.size();
      if (quoted) at = end + 1;
    }
    const std::size_t behind = at;
    while (at < line.size() && !ends_field(line[at])) ++at;
    // A quote that is not closed, or closed within the field, belongs to the text.
    quoted = quoted && trim_blanks(line.substr(behind, at - behind)).empty();
    const auto text =
        quoted ? line.substr(first + 1, end - first - 1) : line.substr(first, at - first);
    fields.push_back({trim_blanks(text), quoted});
    if (at >= line.size()) return;
  }
}

CsvRow::CsvRow(std::string_view line, const CsvDialect& dialect) {
  split_fields(line.substr(0, std::size_t{1} << 22), dialect, fields);
  for (const auto& field : fields) kinds.push_back(kind_of(field.text, dialect.decimal));
  numbers = std::ranges::count(kinds, FieldKind::number);
  words = std::ranges::count(kinds, FieldKind::text);
}

std::vector<CsvField> without_empty_end(std::vector<CsvField> fields) {
  while (!fields.empty() && fields.back().text.empty()) fields.pop_back();
  return fields;
}

bool is_missing_word(std::string_view field) {
  if (field.empty() || field.size() > 10) return false;
  if (std::ranges::all_of(field, [](char c) { return c == '-' || c == '*'; })) {
    return true;
  }
  std::string word = lower_case(field);
  if (word.front() == '-' || word.front() == '+') word.erase(0, 1);
  static constexpr std::string_view kWords =
      "|nan|na|n/a|#n/a|null|none|nil|inf|infinity|1.#inf|1.#qnan|1.#ind|1.#snan|nan(ind)|"
      "missing|invalid|ol|ovl|overload|overflow|#nv|#value!|#div/"
      "0!|#num!|#ref!|?|ovr|over|err|\u221E|";
  return is_listed(kWords, word);
}

bool parse_clock(std::string_view field, double& seconds, int& decimals) {
  if (field.size() < 4 || field.size() > 48) return false;
  std::size_t at = 0;
  const auto sign = [&] { return at < field.size() ? field[at] : '\0'; };
  // The number behind the next sign, if that is one of these; -1: there is none.
  const auto behind = [&](std::string_view signs, std::size_t digits) {
    if (at >= field.size() || signs.find(field[at]) == signs.npos) return -1;
    return digits_at(field, ++at, digits);
  };
  int hours = digits_at(field, at, 4);
  double day_seconds = 0;
  if (const char dash = sign(); hours >= 0 && (dash == '-' || dash == '/' || dash == '.')) {
    const bool year_first = at == 4;
    const std::string_view dashes(&dash, 1);
    int a = hours, b = behind(dashes, 2), c = behind(dashes, 4);
    if (!year_first) std::swap(a, c);
    if (b > 12) std::swap(b, c);  // month first
    if (a < 0 || b < 1 || b > 12 || c < 1 || c > 31) return false;
    // Days that a month does not have run over into the next one.
    const std::chrono::sys_days month = std::chrono::year(a) / b / 1;
    day_seconds = 86400.0 * static_cast<double>(month.time_since_epoch().count() + c - 1);
    while (field.substr(at).starts_with("  ")) ++at;
    hours = behind(" T", 4);
  }
  const int minutes = behind(":", 2);
  if (hours < 0 || hours > 999 || minutes < 0 || minutes > 59) return false;
  int whole = 0;
  double fraction = 0;
  decimals = 0;
  if (sign() == ':') {
    whole = behind(":", 2);
    if (whole < 0 || whole > 60) return false;
    if (sign() == '.' || sign() == ',' || sign() == ':') {
      double unit = 0.1;
      for (++at; is_digit(sign()); ++at, ++decimals, unit /= 10) fraction += unit * (sign() - '0');
    }
  }
  while (sign() == ' ') ++at;
  const std::string rest = lower_case(trim_blanks(field.substr(at)));
  if (const bool after_noon = rest == "pm"; after_noon || rest == "am") {
    hours = hours % 12 + (after_noon ? 12 : 0);
  } else if (!rest.empty() && field[at] != 'Z') {
    // "+02:00", "-0530", "+02" behind a date: hours, minutes off UTC.
    const double side = rest[0] == '-' ? 1 : -1;
    const int zone = behind("+-", 2),
              part = sign() == ':' ? behind(":", 2) : digits_at(field, at, 2);
    if (day_seconds == 0 || zone < 0 || at < field.size()) return false;
    day_seconds += side * (3600.0 * zone + 60.0 * std::max(part, 0));
  }
  seconds = day_seconds + 3600.0 * hours + 60.0 * minutes + whole + fraction;
  return true;
}

FieldKind kind_of(std::string_view field, char decimal) {
  if (field.empty()) return FieldKind::empty;
  double value = 0;
  int decimals = 0;
  if (parse_whole_number(field, decimal, value)) return FieldKind::number;
  if (is_missing_word(field)) return FieldKind::missing;
  if (parse_clock(field, value, decimals)) return FieldKind::clock;
  return FieldKind::text;
}

long line_number(std::string_view bytes, std::size_t offset) {
  long line = 1;
  for (std::string_view rest = bytes;; ++line) {
    take_line(rest);
    if (rest.empty() || bytes.size() - rest.size() > offset) return line;
  }
}

RecordingError text_error(std::string_view bytes, const std::string& file, std::string_view value,
                          std::string problem, std::string remedy, const std::string& channel) {
  const auto at = static_cast<std::size_t>(value.data() - bytes.data());
  const std::size_t line = bytes.substr(0, at).find_last_of("\r\n") + 1;
  return {{file, line_number(bytes, at), value.empty() ? 0 : static_cast<long>(at - line) + 1,
           channel, to_utf8(value.substr(0, 60))},
          std::move(problem),
          std::move(remedy)};
}

std::string_view take_line(std::string_view& rest) {
  std::size_t end = 0;
  while (end < rest.size() && rest[end] != '\n' && rest[end] != '\r') ++end;
  const std::string_view line = rest.substr(0, end);
  rest.remove_prefix(rest.substr(end, 2) == "\r\n" ? end + 2 : std::min(end + 1, rest.size()));
  return line;
}

std::string_view text_without_mark(std::string_view bytes, const std::string& file) {
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  const bool is_wide = bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF");
  if (const auto nul = bytes.substr(0, 4096).find('\0'); is_wide || nul != bytes.npos) {
    throw text_error(
        bytes, file, bytes.substr(is_wide ? 0 : nul, 0),
        is_wide ? "is text in UTF-16" : "holds binary data where text was expected",
        is_wide ? "save it as CSV in UTF-8" : "export the recording as CSV, UFF 58 or LVM");
  }
  return bytes;
}

}  // namespace rigfit::signal
