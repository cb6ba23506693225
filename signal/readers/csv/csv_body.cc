#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "signal/readers/csv/csv_table.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kStride = std::size_t{1} << 24;  // bytes between calls of `progress`
constexpr std::size_t kLongestFooter = 1 << 16;
constexpr char kNotANumber[] = "not a number";
constexpr char kTooLarge[] = "a number too large for a double";

bool is_end(char c) { return c == '\n' || c == '\r'; }

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
  /// Room for `rows`, and for no more than `most_rows`.
  BodyParser(const CsvLayout& layout, const std::vector<bool>& wanted, CsvBody& body,
             Eigen::Index rows, Eigen::Index most_rows)
      : layout_(layout), wanted_(wanted), body_(body), most_rows_(most_rows) {
    target_.resize(layout.columns.size(), nullptr);
    body_.columns.resize(layout.columns.size());
    reserve(rows);
  }

  /// Parses the line at `p`; the text ends with a line end at or before `end - 1`. Returns the
  /// start of the next line. Throws BadLine.
  const char* parse_line(const char* p, const char* end) {
    p = behind_blanks(p);
    if (*p == '#' || *p == '%') {
      ++body_.comment_lines;
      while (!is_end(*p)) ++p;
    }
    if (is_end(*p)) return after_end(p, end);
    if (body_.rows == capacity_) reserve(capacity_ + capacity_ / 2 + 16);
    const bool by_blanks = separator_ == ' ';
    std::size_t c = 0;
    for (;; ++c) {
      if (c >= target_.size()) {
        // Behind the last column only separators may stand.
        for (; !is_end(*p); ++p) {
          if (*p == ' ' || *p == '\t' || *p == separator_) continue;
          throw BadLine{p, c, field_at(p), "more fields than the table has columns",
                        "check for decimal commas, or for a separator inside a field"};
        }
        break;
      }
      p = target_[c] == nullptr ? end_of_field(p) : parse_field(p, end, c);
      if (by_blanks) p = behind_blanks(p);
      if (is_end(*p)) break;
      if (!by_blanks) p = behind_blanks(p + 1);
    }
    // What is not there is missing.
    bool lacking = false;
    for (++c; c < target_.size(); ++c) {
      if (target_[c] == nullptr) continue;
      target_[c][body_.rows] = kMissing;
      lacking = true;
    }
    body_.short_rows += lacking ? 1 : 0;
    ++body_.rows;
    return after_end(p, end);
  }

 private:
  void reserve(Eigen::Index rows) {
    if (capacity_ == most_rows_) throw std::length_error("ragged");
    capacity_ = std::min(rows, most_rows_);
    for (std::size_t c = 0; c < target_.size(); ++c) {
      if (!wanted_[c]) continue;
      body_.columns[c].conservativeResize(capacity_);
      target_[c] = body_.columns[c].data();
    }
  }

  static const char* after_end(const char* p, const char* end) {
    ++p;
    return p < end && p[-1] == '\r' && *p == '\n' ? p + 1 : p;
  }

  const char* behind_blanks(const char* p) const {
    while (*p == ' ' || (*p == '\t' && separator_ != '\t')) ++p;
    return p;
  }

  /// The separator or line end behind the field at `p`.
  const char* end_of_field(const char* p) const {
    if (*p == '"') {
      for (++p; !is_end(*p) && (*p != '"' || p[1] == '"');) p += *p == '"' ? 2 : 1;
    }
    while (!is_end(*p) && *p != separator_ && !(separator_ == ' ' && *p == '\t')) ++p;
    return p;
  }

  std::string_view field_at(const char* p) const {
    return trim_blanks(
        std::string_view(p, static_cast<std::size_t>(end_of_field(p) - p)).substr(0, 60));
  }

  const char* parse_field(const char* p, const char* end, std::size_t c) {
    double value = 0;
    const char* q = parse_number(p, end, decimal_, value);
    if (q == nullptr) return parse_word(p, c);
    const char* r = behind_blanks(q);
    const bool ends = is_end(*r) || (separator_ == ' ' ? r != q : *r == separator_);
    if (!ends) return parse_word(p, c);
    if (!std::isfinite(value)) throw BadLine{p, c, field_at(p), kTooLarge, "check the value"};
    target_[c][body_.rows] = value;
    return r;
  }

  /// A field that does not read as a number at once: quoted, empty, a word for none, a time.
  const char* parse_word(const char* p, std::size_t c) {
    const char* const last = end_of_field(p);
    std::string_view text = trim_blanks(std::string_view(p, static_cast<std::size_t>(last - p)));
    if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
      text = trim_blanks(text.substr(1, text.size() - 2));
    }
    double value = kMissing;
    int decimals = 0;
    if (!text.empty() && !parse_whole_number(text, decimal_, value)) {
      value = kMissing;
      const ColumnKind kind = layout_.columns[c].kind;
      const bool is_clock = kind == ColumnKind::clock && parse_clock(text, value, decimals);
      if (!is_clock && !is_missing_word(text) && kind != ColumnKind::empty) {
        throw BadLine{p, c, text.substr(0, 60), kNotANumber,
                      "fix or delete the line, or leave the field empty where there is no value"};
      }
    }
    if (std::isinf(value)) throw BadLine{p, c, text.substr(0, 60), kTooLarge, "check the value"};
    target_[c][body_.rows] = value;
    return last;
  }

  const CsvLayout& layout_;
  const std::vector<bool>& wanted_;
  CsvBody& body_;
  const char separator_ = layout_.dialect.separator, decimal_ = layout_.dialect.decimal;
  std::vector<double*> target_;
  Eigen::Index capacity_ = 0;
  const Eigen::Index most_rows_;
};

/// Whether some line of `rest` looks like a row: numbers in at least half of the wanted columns.
bool holds_rows(std::string_view rest, const CsvLayout& layout, const std::vector<bool>& wanted) {
  const auto columns = std::count(wanted.begin(), wanted.end(), true);
  std::vector<CsvField> fields;
  while (!rest.empty()) {
    split_fields(take_line(rest), layout.dialect, fields);
    long numbers = 0;
    for (std::size_t c = 0; c < std::min(fields.size(), wanted.size()); ++c) {
      const FieldKind kind = kind_of(fields[c].text, layout.dialect.decimal);
      numbers += wanted[c] && (kind == FieldKind::number || kind == FieldKind::clock) ? 1 : 0;
    }
    if (numbers > 0 && 2 * numbers >= columns) return true;
  }
  return false;
}

/// Rows to make room for: of a long table by its beginning, so that its pages are looked at once.
long likely_rows(std::string_view body) {
  constexpr std::size_t kHead = std::size_t{1} << 20;
  const auto head = body.substr(0, kHead);
  const auto lf = std::count(head.begin(), head.end(), '\n');
  const long rows = (lf > 0 ? lf : std::count(head.begin(), head.end(), '\r')) + 1;
  if (body.size() <= kHead) return rows;
  return static_cast<long>(1.02 * static_cast<double>(rows) * static_cast<double>(body.size()) /
                           static_cast<double>(kHead));
}

/// Whether the last line above the table (of titles or units) stands once more within some lines of
/// `at`: a program that writes one table a cycle, each with its header.
bool begins_anew(std::string_view bytes, std::size_t body, std::size_t at) {
  constexpr std::size_t kHeader = 4096;
  std::string_view line = bytes.substr(0, body);
  line = line.substr(0, line.find_last_not_of("\r\n") + 1);
  line.remove_prefix(line.find_last_of("\r\n") + 1);
  return !trim_blanks(line).empty() &&
         bytes.substr(at, kHeader).find(line) != std::string_view::npos;
}

}  // namespace

CsvBody parse_csv_body(std::string_view bytes, const CsvLayout& layout,
                       const std::vector<bool>& wanted, const std::string& file,
                       const std::function<void(std::size_t)>& progress) {
  CsvBody body;
  const std::size_t n = layout.columns.size();
  const std::string_view text = bytes.substr(layout.body);
  const auto ragged = [&] {
    return RecordingError(
        {file, layout.body_line, 0, "", ""},
        "the lines hold far fewer fields than the widest has columns (" + std::to_string(n) + ")",
        "give a table whose lines all have the same columns");
  };
  // Every field but the last of a line costs at least its separator.
  const auto stored = std::count(wanted.begin(), wanted.end(), true);
  const long most_rows = static_cast<long>(2 * text.size() + 4096) / std::max<long>(stored, 1);
  const long rows = likely_rows(text);
  if (rows > most_rows) throw ragged();
  BodyParser parser(layout, wanted, body, rows, most_rows);

  const auto refuse = [&](std::size_t line_at, const char* line, const BadLine& bad) {
    return RecordingError(
        {file, line_number(bytes, line_at), static_cast<long>(bad.field - line) + 1,
         bad.column < n ? layout.columns[bad.column].name : "", to_utf8(bad.value)},
        bad.problem, bad.remedy);
  };

  // The last line may lack its end, which the parser needs: it is parsed from a copy.
  const std::size_t whole = text.find_last_of("\n\r") + 1;
  const char* p = text.data();
  const char* const end = p + whole;
  try {
    for (const char* told = p; p < end && body.footer_line == 0;) {
      try {
        p = parser.parse_line(p, end);
      } catch (const BadLine& bad) {
        const std::size_t at = layout.body + static_cast<std::size_t>(p - text.data());
        const std::size_t behind = next_line(bytes, line_end(bytes, at));
        const bool is_text = bad.problem == kNotANumber;
        if (is_text && bytes.size() - behind < kLongestFooter && body.rows > 0 &&
            !holds_rows(bytes.substr(behind), layout, wanted)) {
          body.footer_line = line_number(bytes, at);
          break;
        }
        if (is_text && begins_anew(bytes, layout.body, at)) {
          throw RecordingError({file, line_number(bytes, at), 0, "", to_utf8(bytes.substr(at, 40))},
                               "a second table begins here, with titles of its own",
                               "split the file into one for each table");
        }
        throw refuse(at, p, bad);
      }
      if (progress && static_cast<std::size_t>(p - told) > kStride) {
        progress(layout.body + static_cast<std::size_t>(p - text.data()));
        told = p;
      }
    }
    if (body.footer_line == 0 && whole < text.size()) {
      const std::string last = std::string(text.substr(whole)) + '\n';
      const CsvBody before{{}, body.rows, body.short_rows};
      try {
        parser.parse_line(last.data(), last.data() + last.size());
        body.incomplete_last = body.short_rows > before.short_rows && before.rows > 0;
      } catch (const BadLine& bad) {
        if (before.rows == 0) throw refuse(layout.body + whole, last.data(), bad);
        body.incomplete_last = true;
      }
      // A logger that lost its power: the line is not whole.
      if (body.incomplete_last) body.rows = before.rows, body.short_rows = before.short_rows;
    }
  } catch (const std::length_error&) {
    throw ragged();
  }
  // Rows of nothing at the end (spreadsheets leave them).
  const auto is_empty = [&](Eigen::Index row) {
    for (std::size_t c = 0; c < n; ++c) {
      if (wanted[c] && !std::isnan(body.columns[c][row])) return false;
    }
    return true;
  };
  for (; body.rows > 0 && is_empty(body.rows - 1); --body.rows) ++body.empty_rows_at_end;
  for (std::size_t c = 0; c < n; ++c) {
    if (wanted[c]) body.columns[c].conservativeResize(body.rows);
  }
  return body;
}

}  // namespace rigfit::signal
