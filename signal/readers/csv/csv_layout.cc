#include "signal/readers/csv/csv_layout.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "signal/readers/csv/csv_comma.h"
#include "signal/readers/csv/csv_header.h"
#include "signal/readers/files/number_text.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

constexpr std::size_t kLongestLine = std::size_t{1} << 22;  // 4 MiB: 300,000 columns
constexpr std::size_t kSampledLines = 64;

struct Sample {
  std::vector<std::string_view> lines;
};

/// Lines all over the file: every line of a small one, else runs of lines at even distances.
Sample sample_lines(std::string_view bytes) {
  Sample sample;
  const auto take = [&](std::size_t at, std::size_t count) {
    while (count > 0 && at < bytes.size()) {
      const std::size_t end = line_end(bytes, at);
      const auto line = bytes.substr(at, end - at);
      if (!trim_blanks(line).empty() && line.size() < kLongestLine) {
        sample.lines.push_back(line);
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

struct ColumnCount {
  long number = 0, missing = 0, empty = 0, clock = 0, text = 0;
};

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

Trial best_dialect(const Sample& sample, const ReadOptions& options) {
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
    for (const auto& line : sample.lines) {
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
  const bool quotes = std::any_of(sample.lines.begin(), sample.lines.end(), [](const auto& line) {
    return line.find('"') != std::string_view::npos;
  });
  if (quotes && allowed({',', ','})) consider({',', ','});
  return best;
}

/// The table of commas again, where these are decimal signs or may be.
void decide_commas(const Sample& sample, std::size_t columns,
                   const std::vector<std::string_view>& header, const std::string& file,
                   CsvDialect& dialect) {
  std::vector<std::string_view> rows;
  std::vector<CsvField> fields;
  for (const auto& line : sample.lines) {
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
  const Sample sample = sample_lines(bytes);
  if (sample.lines.empty()) throw no_table("no lines of text of a usual length");
  const Trial trial = best_dialect(sample, options);
  if (trial.good_lines == 0) throw no_table("no table of numbers in this text");

  CsvLayout layout;
  layout.dialect = trial.dialect;
  std::vector<CsvField> fields;
  std::vector<ColumnCount> counts(trial.columns);
  long good = 0;
  for (const auto& line : sample.lines) {
    split_fields(line, layout.dialect, fields);
    long numbers = 0;
    if (!is_good(fields, layout.dialect.decimal, numbers)) continue;
    ++good;
    for (const auto& field : fields) {
      layout.has_points |= kind_of(field.text, '.') == FieldKind::number &&
                           field.text.find('.') != std::string_view::npos;
    }
    for (std::size_t c = 0; c < counts.size(); ++c) {
      const auto kind =
          c < fields.size() ? kind_of(fields[c].text, layout.dialect.decimal) : FieldKind::empty;
      ColumnCount& count = counts[c];
      switch (kind) {
        case FieldKind::number:
          ++count.number;
          break;
        case FieldKind::missing:
          ++count.missing;
          break;
        case FieldKind::empty:
          ++count.empty;
          break;
        case FieldKind::clock:
          ++count.clock;
          break;
        case FieldKind::text:
          ++count.text;
          break;
      }
    }
  }
  layout.columns.resize(counts.size());
  for (std::size_t c = 0; c < counts.size(); ++c) {
    const ColumnCount& count = counts[c];
    ColumnKind& kind = layout.columns[c].kind;
    const long some = count.number + count.missing;
    layout.columns[c].filled = static_cast<double>(some) / static_cast<double>(good);
    if (count.clock > some && count.clock >= count.text) {
      kind = ColumnKind::clock;
    } else if (2 * some >= good || (some > 0 && some >= count.text && 10 * count.text <= good)) {
      kind = count.number == 0 && count.missing == 0 ? ColumnKind::empty : ColumnKind::numbers;
      if (2 * some < good && count.text > 0) kind = ColumnKind::text;
    } else {
      kind = count.text > 0 ? ColumnKind::text : ColumnKind::empty;
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
  // The table begins at the first of three lines of numbers with no line of words between: a line
  // of numbers above such a one is part of the header.
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

}  // namespace rigfit::signal
