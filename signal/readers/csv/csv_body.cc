#include "signal/readers/csv/csv_body.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "signal/readers/files/number_text.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kStride = std::size_t{1} << 24;  // bytes between calls of `progress`
constexpr std::size_t kLongestFooter = 1 << 16;
constexpr int kNoDecimals = -400;  // below those of any number
constexpr char kRagged[] = "ragged";

/// A line that is no row of the table.
struct BadLine {
  const char* field = nullptr;
  std::size_t column = 0;
  std::string_view value;
  const char* problem = "";
  const char* remedy = "";
};

class BodyParser {
 public:
  BodyParser(const CsvLayout& layout, const std::vector<bool>& wanted, CsvBody& body,
             Eigen::Index most_rows)
      : layout_(layout), body_(body), decimal_(layout.dialect.decimal), most_rows_(most_rows) {
    const std::size_t n = layout.columns.size();
    target_.resize(n, nullptr);
    wanted_ = wanted;
    wanted_.resize(n, false);
  }

  void reserve(Eigen::Index rows) {
    rows = std::min(rows, most_rows_);
    for (std::size_t c = 0; c < wanted_.size(); ++c) {
      if (!wanted_[c]) continue;
      body_.columns[c].conservativeResize(rows);
      target_[c] = body_.columns[c].data();
    }
    capacity_ = rows;
  }

  /// Parses the line at `p`; the text ends with a line end at or before `end - 1`. Returns the
  /// start of the next line, or nullptr with `bad_` filled.
  const char* parse_line(const char* p, const char* end) {
    const char separator = layout_.dialect.separator;
    const bool by_blanks = separator == ' ';
    const auto skip_blanks = [&] {
      while (*p == ' ' || (*p == '\t' && (by_blanks || separator != '\t'))) ++p;
    };
    const std::size_t n = target_.size();
    skip_blanks();
    if (is_end(*p)) return after_end(p, end);
    if (*p == '#' || *p == '%') {
      while (!is_end(*p)) ++p;
      ++body_.comment_lines;
      return after_end(p, end);
    }
    if (body_.rows == capacity_) {
      if (capacity_ == most_rows_) {
        bad_ = {p, n, field_at(p), kRagged, ""};
        return nullptr;
      }
      reserve(capacity_ + capacity_ / 2 + 16);
    }
    const Eigen::Index row = body_.rows;
    for (std::size_t c = 0;; ++c) {
      if (c >= n) {
        // Behind the last column only separators may stand.
        while (!is_end(*p)) {
          if (*p != ' ' && *p != '\t' && *p != separator) {
            bad_ = {p, n, field_at(p), "more fields than the table has columns",
                    "check for decimal commas, or for a separator inside a field"};
            return nullptr;
          }
          ++p;
        }
        break;
      }
      if (target_[c] != nullptr) {
        double value = 0;
        const char* q = parse_number(p, end, decimal_, value);
        if (q != nullptr) {
          // Blanks behind a number, then the separator.
          const char* r = q;
          while (*r == ' ' || *r == '\t') {
            if (*r == separator && !by_blanks) break;
            ++r;
          }
          if (by_blanks ? (r != q || is_end(*r)) : (*r == separator || is_end(*r))) {
            if (!std::isfinite(value)) {
              bad_ = {p, c, field_at(p), "a number too large for a double", "check the value"};
              return nullptr;
            }
            target_[c][row] = value;
            p = r;
            if (is_end(*p)) {
              finish_row(row, c + 1);
              break;
            }
            if (!by_blanks) {
              ++p;
              skip_blanks();
            }
            continue;
          }
        }
        p = parse_word(p, c, row);
        if (p == nullptr) return nullptr;
      } else {
        p = end_of_field(p);
      }
      if (by_blanks) skip_blanks();
      if (is_end(*p)) {
        finish_row(row, c + 1);
        break;
      }
      if (!by_blanks) {
        ++p;
        skip_blanks();
      }
    }
    ++body_.rows;
    return after_end(p, end);
  }

  [[nodiscard]] const BadLine& bad() const { return bad_; }
  [[nodiscard]] long last_fields() const { return last_fields_; }

  static bool is_end(char c) { return c == '\n' || c == '\r'; }

 private:
  static const char* after_end(const char* p, const char* end) {
    ++p;
    if (p < end && p[-1] == '\r' && *p == '\n') ++p;
    return p;
  }

  /// The separator or line end behind the field at `p`.
  const char* end_of_field(const char* p) const {
    const char separator = layout_.dialect.separator;
    if (*p == '"') {
      const char* q = p + 1;
      while (!is_end(*q)) {
        if (*q == '"') {
          if (q[1] != '"') break;
          ++q;
        }
        ++q;
      }
      p = is_end(*q) ? q : q + 1;
    }
    while (!is_end(*p) && *p != separator && !(separator == ' ' && *p == '\t')) ++p;
    return p;
  }

  std::string_view field_at(const char* p) const {
    return trim_blanks(
        std::string_view(p, static_cast<std::size_t>(end_of_field(p) - p)).substr(0, 60));
  }

  /// A field that does not read as a number at once: quoted, empty, a word for none, a time.
  const char* parse_word(const char* p, std::size_t c, Eigen::Index row) {
    const char* const last = end_of_field(p);
    std::string_view text = trim_blanks(std::string_view(p, static_cast<std::size_t>(last - p)));
    if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
      text = trim_blanks(text.substr(1, text.size() - 2));
    }
    double value = kMissing;
    int decimals = kNoDecimals;
    if (!text.empty() && !parse_whole_number(text, decimal_, value)) {
      value = kMissing;
      const ColumnKind kind = layout_.columns[c].kind;
      const bool known = is_missing_word(text) ||
                         (kind == ColumnKind::clock && parse_clock(text, value, decimals));
      if (!known && kind != ColumnKind::empty) {
        bad_ = {p, c, text.substr(0, 60), "not a number",
                "fix or delete the line, or leave the field empty where there is no value"};
        return nullptr;
      }
    } else if (std::isinf(value)) {
      bad_ = {p, c, text.substr(0, 60), "a number too large for a double", "check the value"};
      return nullptr;
    }
    if (std::isnan(value)) ++body_.missing[c];
    if (decimals > body_.decimals[c]) body_.decimals[c] = decimals;
    target_[c][row] = value;
    return last;
  }

  /// The row ended after `fields` fields; what is not there is missing.
  void finish_row(Eigen::Index row, std::size_t fields) {
    last_fields_ = static_cast<long>(fields);
    bool lacking = false;
    for (std::size_t c = fields; c < target_.size(); ++c) {
      if (target_[c] == nullptr) continue;
      target_[c][row] = kMissing;
      ++body_.missing[c];
      lacking = true;
    }
    if (lacking && body_.short_rows++ == 0) first_short_row_ = row;
  }

  const CsvLayout& layout_;
  CsvBody& body_;
  const char decimal_;
  std::vector<double*> target_;
  std::vector<bool> wanted_;
  Eigen::Index capacity_ = 0;
  Eigen::Index most_rows_;
  Eigen::Index first_short_row_ = -1;
  long last_fields_ = 0;
  BadLine bad_;
};

/// Whether some line of `rest` looks like a row: numbers in at least half of the wanted columns.
bool holds_rows(std::string_view rest, const CsvLayout& layout, const std::vector<bool>& wanted) {
  std::vector<CsvField> fields;
  for (std::size_t at = 0; at < rest.size();) {
    const std::size_t end = line_end(rest, at);
    split_fields(rest.substr(at, end - at), layout.dialect, fields);
    long numbers = 0, columns = 0;
    for (std::size_t c = 0; c < wanted.size(); ++c) {
      if (!wanted[c]) continue;
      ++columns;
      const auto kind =
          c < fields.size() ? kind_of(fields[c].text, layout.dialect.decimal) : FieldKind::empty;
      numbers += kind == FieldKind::number || kind == FieldKind::clock ? 1 : 0;
    }
    if (numbers > 0 && 2 * numbers >= columns) return true;
    at = next_line(rest, end);
  }
  return false;
}

long bound_of_rows(std::string_view body) {
  const auto lf = std::count(body.begin(), body.end(), '\n');
  return (lf > 0 ? lf : std::count(body.begin(), body.end(), '\r')) + 1;
}

/// Rows to make room for: of a long table by its beginning, so that its pages are looked at once.
long likely_rows(std::string_view body) {
  constexpr std::size_t kHead = std::size_t{1} << 20;
  const long rows = bound_of_rows(body.substr(0, kHead));
  if (body.size() <= kHead) return rows;
  return static_cast<long>(1.02 * static_cast<double>(rows) * static_cast<double>(body.size()) /
                           static_cast<double>(kHead));
}

/// Most decimals printed in the lines from `at` to `end`, where it is more than before.
void find_decimals(std::string_view bytes, std::size_t at, std::size_t end, const CsvLayout& layout,
                   CsvBody& body) {
  std::vector<CsvField> fields;
  double value = 0;
  while (at < end) {
    const std::size_t line = line_end(bytes, at);
    split_fields(bytes.substr(at, line - at), layout.dialect, fields);
    for (std::size_t c = 0; c < std::min(fields.size(), body.decimals.size()); ++c) {
      if (!parse_whole_number(fields[c].text, layout.dialect.decimal, value)) continue;
      body.decimals[c] =
          std::max(body.decimals[c], printed_decimals(fields[c].text, layout.dialect.decimal));
    }
    at = next_line(bytes, line);
  }
}

/// Most decimals printed in the last lines of each wanted column, in the first ones where the last
/// hold no number.
void find_decimals(std::string_view bytes, const CsvLayout& layout, const std::vector<bool>& wanted,
                   CsvBody& body) {
  constexpr std::size_t kBytes = 1 << 13;
  constexpr long kLines = 32;  // or so many lines, where rows are long
  const std::size_t size = bytes.size();
  std::size_t at = layout.body;
  for (std::size_t tail = kBytes; size - layout.body > tail; tail *= 2) {
    at = next_line(bytes, line_end(bytes, size - tail));
    if (bound_of_rows(bytes.substr(at)) > kLines) break;
    at = layout.body;
  }
  find_decimals(bytes, at, size, layout, body);
  bool lacking = false;
  for (std::size_t c = 0; c < wanted.size(); ++c) {
    lacking = lacking || (wanted[c] && body.decimals[c] == kNoDecimals);
  }
  if (!lacking || at == layout.body) return;
  std::size_t end = layout.body;
  for (long k = 0; end < at && (k < kLines || end - layout.body < kBytes); ++k) {
    end = next_line(bytes, line_end(bytes, end));
  }
  CsvBody head;
  head.decimals.assign(body.decimals.size(), kNoDecimals);
  find_decimals(bytes, layout.body, end, layout, head);
  for (std::size_t c = 0; c < body.decimals.size(); ++c) {
    if (body.decimals[c] == kNoDecimals) body.decimals[c] = head.decimals[c];
  }
}

/// Whether the last line above the table (of titles or units) stands once more within some lines of
/// `at`: a program that writes one table a cycle, each with its header.
bool begins_anew(std::string_view bytes, std::size_t body, std::size_t at) {
  constexpr std::size_t kHeader = 4096;
  const std::string_view above = bytes.substr(0, body);
  const std::size_t end = above.find_last_not_of("\r\n");
  if (end == std::string_view::npos) return false;
  const std::size_t begin = above.find_last_of("\r\n", end);
  const auto line = above.substr(begin == std::string_view::npos ? 0 : begin + 1,
                                 end - (begin == std::string_view::npos ? 0 : begin + 1) + 1);
  return !trim_blanks(line).empty() &&
         bytes.substr(at, kHeader).find(line) != std::string_view::npos;
}

}  // namespace

CsvBody parse_csv_body(std::string_view bytes, const CsvLayout& layout,
                       const std::vector<bool>& wanted, const std::string& file,
                       const std::function<void(std::size_t)>& progress) {
  CsvBody body;
  const std::size_t n = layout.columns.size();
  body.columns.resize(n);
  body.missing.assign(n, 0);
  body.decimals.assign(n, kNoDecimals);
  const std::string_view text = bytes.substr(layout.body);
  const long rows = likely_rows(text);
  const auto stored = static_cast<long>(std::count(wanted.begin(), wanted.end(), true));
  const auto ragged = [&] {
    return RecordingError(
        {file, layout.body_line, 0, "", ""},
        "the lines hold far fewer fields than the widest has columns (" + std::to_string(n) + ")",
        "give a table whose lines all have the same columns");
  };
  // Every field but the last of a line costs at least its separator.
  const long most_rows = static_cast<long>((2 * text.size() + 4096) /
                                           static_cast<std::size_t>(std::max<long>(stored, 1)));
  if (rows > most_rows) throw ragged();
  find_decimals(bytes, layout, wanted, body);
  BodyParser parser(layout, wanted, body, most_rows);
  parser.reserve(rows);

  const auto refuse = [&](std::size_t line_at, const char* line, const BadLine& bad) {
    const auto number = line_number(bytes, line_at);
    const std::string channel = bad.column < n && !layout.columns[bad.column].name.empty()
                                    ? layout.columns[bad.column].name
                                    : "";
    const auto column = static_cast<long>(bad.field - line) + 1;
    return RecordingError({file, number, column, channel, to_utf8(bad.value)}, bad.problem,
                          bad.remedy);
  };

  // The last line may lack its end, which the parser needs: it is parsed from a copy.
  const std::size_t safe = text.find_last_of("\n\r");
  const std::size_t whole = safe == std::string_view::npos ? 0 : safe + 1;
  const char* p = text.data();
  const char* const end = p + whole;
  const char* told = p;
  bool ended = false;
  while (p < end) {
    const Eigen::Index rows_before = body.rows;
    const char* const next = parser.parse_line(p, end);
    if (next == nullptr) {
      if (parser.bad().problem == kRagged) throw ragged();
      body.rows = rows_before;
      const std::size_t at = layout.body + static_cast<std::size_t>(p - text.data());
      const std::size_t behind = next_line(bytes, line_end(bytes, at));
      const bool is_text = *parser.bad().problem == 'n';
      if (is_text && bytes.size() - behind < kLongestFooter &&
          !holds_rows(bytes.substr(behind), layout, wanted) && body.rows > 0) {
        body.footer_line = line_number(bytes, at);
        ended = true;
        break;
      }
      if (is_text && begins_anew(bytes, layout.body, at)) {
        throw RecordingError({file, line_number(bytes, at), 0, "", to_utf8(bytes.substr(at, 40))},
                             "a second table begins here, with titles of its own",
                             "split the file into one for each table");
      }
      throw refuse(at, p, parser.bad());
    }
    p = next;
    if (progress && static_cast<std::size_t>(p - told) > kStride) {
      progress(layout.body + static_cast<std::size_t>(p - text.data()));
      told = p;
    }
  }
  if (!ended && whole < text.size()) {
    const std::string last = std::string(text.substr(whole)) + '\n';
    const Eigen::Index rows_before = body.rows;
    const long short_before = body.short_rows;
    const bool good = parser.parse_line(last.data(), last.data() + last.size()) != nullptr;
    const bool broken = !good || body.short_rows > short_before;
    if (broken && rows_before > 0) {
      // A logger that lost its power: the line is not whole.
      body.rows = rows_before;
      body.short_rows = short_before;
      body.incomplete_last = true;
    } else if (!good) {
      throw refuse(layout.body + whole, last.data(), parser.bad());
    }
  }
  // A row given up half way has been counted in part.
  if (body.footer_line > 0 || body.incomplete_last) {
    for (std::size_t c = 0; c < n; ++c) {
      if (wanted[c]) {
        body.missing[c] =
            static_cast<long>(body.columns[c].head(body.rows).array().isNaN().count());
      }
    }
  }
  // Numbers far from both ends only: taken to have all their digits.
  std::replace(body.decimals.begin(), body.decimals.end(), kNoDecimals, -kNoDecimals);
  // Rows of nothing at the end (spreadsheets leave them).
  const auto all_missing = [&](Eigen::Index row) {
    for (std::size_t c = 0; c < n; ++c) {
      if (wanted[c] && !std::isnan(body.columns[c][row])) return false;
    }
    return true;
  };
  while (body.rows > 0 && all_missing(body.rows - 1)) {
    --body.rows;
    ++body.empty_rows_at_end;
    for (std::size_t c = 0; c < n; ++c) body.missing[c] -= wanted[c] ? 1 : 0;
  }
  for (std::size_t c = 0; c < n; ++c) {
    if (wanted[c] && body.columns[c].size() != body.rows) {
      body.columns[c].conservativeResize(body.rows);
    }
  }
  return body;
}

}  // namespace rigfit::signal
