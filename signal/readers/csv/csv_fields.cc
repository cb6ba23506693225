#include "signal/readers/csv/csv_fields.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "signal/readers/files/number_text.h"

namespace rigfit::signal {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// Unsigned decimal digits at `at`, at most `most` of them; -1 when there are none.
int digits_at(std::string_view s, std::size_t& at, std::size_t most) {
  int value = 0;
  std::size_t count = 0;
  while (at < s.size() && count < most && std::isdigit(static_cast<unsigned char>(s[at]))) {
    value = value * 10 + (s[at] - '0');
    ++at, ++count;
  }
  return count == 0 ? -1 : value;
}

/// Days from 1970-01-01 in the proleptic Gregorian calendar.
long days_from_civil(long year, long month, long day) {
  const long y = month <= 2 ? year - 1 : year;
  const long era = (y >= 0 ? y : y - 399) / 400;
  const long year_of_era = y - era * 400;
  const long day_of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  const long day_of_era = year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year;
  return era * 146097 + day_of_era - 719468;
}

}  // namespace

std::string_view trim_blanks(std::string_view s) {
  while (!s.empty() && is_blank(s.front())) s.remove_prefix(1);
  while (!s.empty() && is_blank(s.back())) s.remove_suffix(1);
  return s;
}

bool is_listed(std::string_view list, const std::string& word) {
  return word.find('|') == std::string::npos &&
         list.find("|" + word + "|") != std::string_view::npos;
}

std::string lower_case(std::string_view s) {
  std::string out(s);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

void split_fields(std::string_view line, const CsvDialect& dialect, std::vector<CsvField>& fields) {
  fields.clear();
  const bool by_blanks = dialect.separator == ' ';
  const auto is_space = [&](char c) { return is_blank(c) && c != dialect.separator; };
  const auto ends_field = [&](char c) { return by_blanks ? is_blank(c) : c == dialect.separator; };
  std::size_t at = 0;
  while (true) {
    while (at < line.size() && (by_blanks ? is_blank(line[at]) : is_space(line[at]))) ++at;
    if (by_blanks && at >= line.size()) return;
    CsvField field;
    if (at < line.size() && line[at] == '"') {
      std::size_t close = at + 1;
      while (close < line.size()) {
        if (line[close] == '"') {
          if (close + 1 < line.size() && line[close + 1] == '"') {
            ++close;
          } else {
            break;
          }
        }
        ++close;
      }
      field.text = trim_blanks(line.substr(at + 1, std::min(close, line.size()) - at - 1));
      field.quoted = true;
      at = std::min(close + 1, line.size());
      while (at < line.size() && !ends_field(line[at])) ++at;
    } else {
      const std::size_t first = at;
      while (at < line.size() && !ends_field(line[at])) ++at;
      field.text = trim_blanks(line.substr(first, at - first));
    }
    fields.push_back(field);
    if (at >= line.size()) return;
    ++at;
  }
}

bool is_missing_word(std::string_view field) {
  if (field.empty() || field.size() > 10) return false;
  if (std::all_of(field.begin(), field.end(), [](char c) { return c == '-' || c == '*'; })) {
    return true;
  }
  std::string word = lower_case(field);
  if (word.front() == '-' || word.front() == '+') word.erase(0, 1);
  static constexpr std::string_view kWords =
      "|nan|na|n/a|#n/a|null|none|nil|inf|infinity|1.#inf|1.#qnan|1.#ind|1.#snan|nan(ind)|"
      "missing|invalid|ovl|overload|#value!|#div/0!|#num!|#ref!|?|ovr|over|err|";
  return is_listed(kWords, word);
}

bool parse_clock(std::string_view field, double& seconds, int& decimals) {
  if (field.size() < 4 || field.size() > 48 || field.find(':') == std::string_view::npos) {
    return false;
  }
  double day_seconds = 0;
  std::size_t at = 0;
  const std::size_t split = field.find_first_of(" T");
  if (split != std::string_view::npos && split > 0 && split < field.find(':')) {
    const std::string_view date = field.substr(0, split);
    int a = digits_at(date, at, 4);
    if (a < 0 || at >= date.size()) return false;
    const bool year_first = at == 4;
    const char sign = date[at++];
    if (sign != '-' && sign != '/' && sign != '.') return false;
    int b = digits_at(date, at, 2);
    if (b < 0 || at >= date.size() || date[at++] != sign) return false;
    int c = digits_at(date, at, 4);
    if (c < 0 || at != date.size()) return false;
    if (!year_first) std::swap(a, c);
    if (b > 12) std::swap(b, c);  // month first
    if (b < 1 || b > 12 || c < 1 || c > 31) return false;
    day_seconds = 86400.0 * static_cast<double>(days_from_civil(a, b, c));
    at = split + 1;
    while (at < field.size() && field[at] == ' ') ++at;
  }
  const int hours = digits_at(field, at, 3);
  if (hours < 0 || at >= field.size() || field[at++] != ':') return false;
  const int minutes = digits_at(field, at, 2);
  if (minutes < 0 || minutes > 59) return false;
  int whole = 0;
  double fraction = 0;
  decimals = 0;
  if (at < field.size() && field[at] == ':') {
    ++at;
    whole = digits_at(field, at, 2);
    if (whole < 0 || whole > 60) return false;
    if (at < field.size() && (field[at] == '.' || field[at] == ',' || field[at] == ':')) {
      ++at;
      double unit = 0.1;
      while (at < field.size() && std::isdigit(static_cast<unsigned char>(field[at]))) {
        fraction += unit * (field[at++] - '0');
        unit /= 10;
        ++decimals;
      }
    }
  }
  if (at < field.size() && field[at] != 'Z') return false;
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

}  // namespace rigfit::signal
