#include "signal/readers/csv/csv_fields.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <chrono>
#include <cstdlib>

#include "signal/recording/recording_error.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

bool is_digit(char c) { return static_cast<unsigned char>(c - '0') < 10; }

const char* skip_digits(const char* p) {
  while (is_digit(*p)) ++p;
  return p;
}

bool is_exponent(const char* p) {
  const char letter = static_cast<char>(*p | 0x20);
  return (letter == 'e' || letter == 'd') && is_digit(p[p[1] == '-' || p[1] == '+' ? 2 : 1]);
}

/// The number from `first` on as std::from_chars wants it: a decimal point, e before the exponent.
const char* parse_copy(const char* first, char decimal, double& value) {
  const char* last = skip_digits(*first == '-' ? first + 1 : first);
  if (*last == decimal) last = skip_digits(last + 1);
  if (is_exponent(last)) last = skip_digits(last + (is_digit(last[1]) ? 1 : 2));
  std::array<char, 64> small{};
  std::string large;
  const auto size = static_cast<std::size_t>(last - first);
  if (size >= small.size()) large.resize(size + 1);
  char* const copy = large.empty() ? small.data() : large.data();
  std::transform(first, last, copy, [decimal](char c) {
    return c == decimal ? '.' : c == 'd' || c == 'D' ? 'e' : c;
  });
  const auto error = std::from_chars(copy, copy + size, value).ec;
  // from_chars does not say whether the number is too large or too small; strtod does.
  if (error == std::errc::result_out_of_range) value = std::strtod(copy, nullptr);
  return last;
}

/// Unsigned decimal digits at `at`, at most `most` of them; -1 when there are none.
int digits_at(std::string_view s, std::size_t& at, std::size_t most) {
  int value = -1;
  for (std::size_t last = at + most; at < std::min(last, s.size()) && is_digit(s[at]); ++at) {
    value = std::max(value, 0) * 10 + (s[at] - '0');
  }
  return value;
}

}  // namespace

const char* parse_number(const char* p, const char* end, char decimal, double& value) {
  const bool plus = *p == '+';
  if (plus) ++p;
  const char* const digits = !plus && *p == '-' ? p + 1 : p;
  if (!is_digit(*digits) && !(*digits == decimal && is_digit(digits[1]))) return nullptr;
  if (decimal == '.') {
    const auto [behind, error] = std::from_chars(p, end, value);
    if (error == std::errc() && !is_exponent(behind)) return behind;
  }
  return parse_copy(p, decimal, value);
}

bool parse_whole_number(std::string_view text, char decimal, double& value) {
  if (text.empty()) return false;
  const std::string copy = std::string(text) + '\n';
  const char* const end = copy.data() + copy.size();
  return parse_number(copy.data(), end, decimal, value) == end - 1;
}

int printed_decimals(std::string_view text, char decimal) {
  int decimals = 0;
  bool behind = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (c == decimal) {
      behind = true;
    } else if (is_digit(c)) {
      if (behind) ++decimals;
    } else if (c == 'e' || c == 'E' || c == 'd' || c == 'D') {
      const std::size_t first = k + 1 < text.size() && text[k + 1] == '+' ? k + 2 : k + 1;
      int written = 0;
      std::from_chars(text.data() + first, text.data() + text.size(), written);
      return decimals - std::clamp(written, -400, 400);
    }
  }
  return decimals;
}

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
  const auto ends_field = [&](char c) { return by_blanks ? is_blank(c) : c == dialect.separator; };
  for (std::size_t at = 0;; ++at) {
    while (at < line.size() && is_blank(line[at]) && (by_blanks || !ends_field(line[at]))) ++at;
    if (by_blanks && at >= line.size()) return;
    std::size_t first = at, end = at;
    const bool quoted = at < line.size() && line[at] == '"';
    if (quoted) {
      first = end = at + 1;
      while (end < line.size() && (line[end] != '"' || line.substr(end, 2) == "\"\"")) {
        end += line[end] == '"' ? 2 : 1;
      }
      end = std::min(end, line.size());
      at = std::min(end + 1, line.size());
    }
    while (at < line.size() && !ends_field(line[at])) ++at;
    fields.push_back({trim_blanks(line.substr(first, (quoted ? end : at) - first)), quoted});
    if (at >= line.size()) return;
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
  if (field.size() < 4 || field.size() > 48) return false;
  std::size_t at = 0;
  const auto sign = [&] { return at < field.size() ? field[at] : '\0'; };
  int a = digits_at(field, at, 4);
  double day_seconds = 0;
  if (const char dash = sign(); a >= 0 && (dash == '-' || dash == '/' || dash == '.')) {
    const bool year_first = at == 4;
    ++at;
    int b = digits_at(field, at, 2);
    if (b < 0 || sign() != dash) return false;
    ++at;
    int c = digits_at(field, at, 4);
    if (!year_first) std::swap(a, c);
    if (b > 12) std::swap(b, c);  // month first
    if (a < 0 || b < 1 || b > 12 || c < 1 || c > 31 || (sign() != ' ' && sign() != 'T')) {
      return false;
    }
    // Days that a month does not have run over into the next one.
    const std::chrono::sys_days month = std::chrono::year(a) / b / 1;
    day_seconds = 86400.0 * static_cast<double>(month.time_since_epoch().count() + c - 1);
    ++at;
    while (sign() == ' ') ++at;
    a = digits_at(field, at, 4);
  }
  if (a < 0 || a > 999 || sign() != ':') return false;
  const int hours = a;
  ++at;
  const int minutes = digits_at(field, at, 2);
  if (minutes < 0 || minutes > 59) return false;
  int whole = 0;
  double fraction = 0;
  decimals = 0;
  if (sign() == ':') {
    ++at;
    whole = digits_at(field, at, 2);
    if (whole < 0 || whole > 60) return false;
    if (sign() == '.' || sign() == ',' || sign() == ':') {
      double unit = 0.1;
      for (++at; is_digit(sign()); ++at, ++decimals, unit /= 10) fraction += unit * (sign() - '0');
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

std::string_view take_line(std::string_view& rest) {
  const std::size_t end = line_end(rest, 0);
  const std::string_view line = rest.substr(0, end);
  rest.remove_prefix(next_line(rest, end));
  return line;
}

std::string_view text_without_mark(std::string_view bytes, std::string& converted,
                                   const std::string& file) {
  if (bytes.size() >= 2 && (bytes.substr(0, 2) == "\xFF\xFE" || bytes.substr(0, 2) == "\xFE\xFF")) {
    converted = utf16_to_utf8(bytes.substr(2), bytes[0] == '\xFF');
    return converted;
  }
  if (bytes.substr(0, 3) == "\xEF\xBB\xBF") bytes.remove_prefix(3);
  const auto head = bytes.substr(0, 4096);
  // Without a mark: every second byte of (nearly) plain text is zero.
  long zeros[2] = {0, 0};
  for (std::size_t k = 0; k < head.size(); ++k) zeros[k % 2] += head[k] == '\0' ? 1 : 0;
  const auto half = static_cast<long>(head.size() / 2);
  if (half > 0 && std::min(zeros[0], zeros[1]) == 0 &&
      std::max(zeros[0], zeros[1]) > half - half / 8) {
    converted = utf16_to_utf8(bytes, zeros[1] > 0);
    return converted;
  }
  if (const auto nul = head.find('\0'); nul != std::string_view::npos) {
    throw RecordingError({file, line_number(bytes, nul), 0, "", ""},
                         "holds binary data where text was expected",
                         "export the recording as CSV, UFF 58 or LVM");
  }
  return bytes;
}

}  // namespace rigfit::signal
