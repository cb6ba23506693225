#include "signal/readers/csv_table.h"

#include <regex>

#include "signal/recording/recording.h"

namespace rigfit::signal {
namespace {

constexpr long kSampledLines = 64;  // of a large file, and again as its last ones

using Row = CsvRow;

// ---- Lines all over the file: separator, decimal sign, kinds of columns

/// Every line of a small file, else runs of lines at even distances and the last ones.
std::vector<std::string_view> sample_lines(std::string_view bytes) {
  std::vector<std::string_view> sample;
  const auto take = [&](std::string_view rest, std::ptrdiff_t count) {
    while (count > 0 && !rest.empty()) {
      const auto line = take_line(rest);
      if (trim_blanks(line).empty()) continue;
      sample.push_back(line);
      --count;
    }
  };
  if (bytes.size() <= 1 << 14) {
    take(bytes, std::ssize(bytes));
    return sample;
  }
  constexpr std::size_t kRuns = 16;
  for (std::size_t run = 1; run <= kRuns; ++run) {
    auto rest = bytes.substr(bytes.size() / (kRuns + 1) * run);
    take_line(rest);  // a part of one
    take(rest, kSampledLines / kRuns);
  }
  std::size_t at = bytes.size();
  for (long k = 0; k < kSampledLines && at > 0; ++k) {
    at = bytes.find_last_of("\r\n", at - 1);
    if (at == std::string_view::npos) return sample;
  }
  auto last = bytes.substr(at);
  take_line(last);
  take(last, kSampledLines);
  return sample;
}

/// The lines that can be rows of the table.
std::vector<Row> rows_of(const std::vector<std::string_view>& sample, const CsvDialect& dialect) {
  std::vector<Row> rows;
  for (const auto& line : sample) {
    if (Row row(line, dialect); row.is_good()) rows.push_back(std::move(row));
  }
  return rows;
}

/// Rows of the dialect that reads most of the text as numbers and leaves least of it as words, and
/// of those the one by which most lines are rows. Empty: none reads a row.
std::vector<Row> rows_of_best_dialect(const std::vector<std::string_view>& sample,
                                      const ReadOptions& options, CsvDialect& best) {
  std::vector<CsvDialect> dialects = {{'\t', '.'}, {'\t', ','}, {';', '.'}, {';', ','}, {'|', '.'},
                                      {'|', ','},  {',', '.'},  {' ', '.'}, {' ', ','}};
  // "1,5","2,5": a comma inside quotes is the decimal sign of a table separated by commas.
  if (std::ranges::any_of(sample, [](auto line) { return line.find('"') != line.npos; })) {
    dialects.push_back({',', ','});
  }
  std::vector<Row> best_rows;
  long most_worth = 0;
  for (const auto& dialect : dialects) {
    if ((options.separator != 0 && dialect.separator != options.separator) ||
        (options.decimal != 0 && dialect.decimal != options.decimal)) {
      continue;
    }
    auto rows = rows_of(sample, dialect);
    long worth = 0;
    for (const auto& row : rows) worth += row.numbers - row.words;
    if (std::pair(worth, rows.size()) > std::pair(most_worth, best_rows.size())) {
      best_rows = std::move(rows);
      most_worth = worth;
      best = dialect;
    }
  }
  return best_rows;
}

/// What each column holds in the rows looked at.
std::vector<CsvColumn> columns_of(const std::vector<Row>& rows) {
  std::vector<CsvColumn> columns;
  for (const auto& row : rows) columns.resize(std::max(columns.size(), row.fields.size()));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    columns[c].place = c;
    const auto count = [&](FieldKind kind) {
      return std::ranges::count_if(rows, [&](const Row& row) { return row.kind(c) == kind; });
    };
    const long some = count(FieldKind::number) + count(FieldKind::missing);
    const long clock = count(FieldKind::clock), text = count(FieldKind::text);
    const long all = std::ssize(rows);
    columns[c].filled = static_cast<double>(some + clock) / static_cast<double>(all);
    columns[c].kind = clock > some && clock >= text                ? FieldKind::clock
                      : some > 0 && (2 * some >= all || text == 0) ? FieldKind::number
                      : text > 0                                   ? FieldKind::text
                                                                   : FieldKind::empty;
    if (columns[c].kind != FieldKind::text) continue;
    for (const auto& row : rows) {
      double value = 0;
      int decimals = 0;
      if (row.kind(c) != FieldKind::text) continue;
      const auto words = row.fields[c].text.substr(0, 40);
      const bool is_date = parse_clock(std::string(words) + " 0:0", value, decimals);
      const bool is_data = some > 0 || (parse_number(words, '.', value) > 0 && !is_date);
      if (is_data && columns[c].unread.empty()) columns[c].unread = words;
    }
  }
  return columns;
}

// ---- The comma in a table of whole numbers

/// "12", "-3", "+05"; no decimal point, no exponent.
bool is_whole(std::string_view text) {
  if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
  return !text.empty() && text.size() < 16 &&
         text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// Refuses a table by commas that may be decimal signs: of whole numbers in two columns unless each
/// has a title, and of more where every second column has one or begins with a zero.
void refuse_decimal_commas(const std::vector<Row>& rows,
                           const std::vector<std::string_view>& header, const std::string& file,
                           const CsvDialect& dialect) {
  std::size_t columns = 0;
  for (const auto& row : rows) columns = std::max(columns, without_empty_end(row.fields).size());
  bool whole = columns % 2 == 0;
  bool zero = false;  // "05", or "-0" in front: no column of whole numbers is so written
  for (const auto& row : rows) {
    const auto fields = without_empty_end(row.fields);
    whole = whole && (fields.size() == columns || (columns == 2 && fields.size() == 1));
    for (std::size_t c = 0; c < fields.size(); ++c) {
      const auto text = fields[c].text;
      if (text.find('.') != std::string_view::npos) return;
      whole = whole && !fields[c].quoted && is_whole(text);
      if (!whole || c % 2 == 0) continue;
      // No decimals have a sign or a blank in front.
      whole = text.front() != '-' && text.front() != '+' && text.data()[-1] == ',';
      zero |= (text.size() > 1 && text.front() == '0') || fields[c - 1].text == "-0";
    }
  }
  std::string_view line;
  for (const auto one : header) line = trim_blanks(one).empty() ? line : one;
  const Row above(line, dialect);
  const std::size_t titles = without_empty_end(above.fields).size();
  const bool one = whole && columns == 2;
  const bool both = (2 * titles == columns && above.numbers == 0) || (whole && zero);
  if (titles == columns || (!one && !both)) return;
  throw RecordingError({file, static_cast<long>(header.size()) + 1, 1, "", ""},
                       "the commas may part columns of whole numbers or be decimal signs",
                       "say it: --decimal comma or --separator comma (keys decimal, separator of "
                       "the TOML file beside it), or write semicolons between columns");
}

/// Refuses a table by commas in quotes that all stand before three digits: decimals or thousands.
void refuse_thousands(const std::vector<Row>& rows, long line, const std::string& file) {
  static const std::regex kBoth("[-+]*[1-9][0-9]{0,2},[0-9]{3}");
  std::string seen;
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < row.fields.size(); ++c) {
      const std::string text(row.fields[c].text);
      if (row.kind(c) != FieldKind::number || text.find(',') == text.npos) continue;
      if (!std::regex_match(text, kBoth)) return;
      seen = text;
    }
  }
  if (seen.empty()) return;
  throw RecordingError({file, line, 0, "", seen},
                       "the commas in quotes may part thousands or be decimal signs",
                       "say --decimal comma (key decimal of the TOML file beside it) where they "
                       "are decimal signs; else export without signs between thousands");
}

/// Whether a line is one of numbers, as the columns hold them.
bool is_csv_row(std::string_view line, const CsvLayout& layout) {
  const Row row(line, layout.dialect);
  long numbers = 0, columns = 0;
  for (std::size_t c = 0; c < layout.columns.size(); ++c) {
    const FieldKind kind = row.kind(c);
    const FieldKind expected = layout.columns[c].kind;
    if (expected == FieldKind::number) {
      if (kind == FieldKind::text || kind == FieldKind::clock) return false;
      ++columns;
      numbers += kind == FieldKind::number ? 1 : 0;
    } else if (c < row.fields.size() &&
               ((expected == FieldKind::clock && kind != FieldKind::clock) ||
                (expected == FieldKind::empty && c == 0 && kind != FieldKind::empty))) {
      return false;
    }
  }
  return numbers > 0 && (2 * numbers >= columns || row.fields.size() == layout.columns.size());
}

/// Whether a line has a number in each of the table's columns beside a setting and its value, which
/// the columns in front of them hold: oscilloscopes write theirs beside the first samples.
bool is_row_beside_settings(std::string_view line, const CsvLayout& layout) {
  const Row row(line, layout.dialect);
  long settings = 0;
  for (std::size_t c = 0; c < layout.columns.size(); ++c) {
    const FieldKind kind = row.kind(c), expected = layout.columns[c].kind;
    if (layout.columns[c].has_data() && kind != expected) return false;
    settings += expected == FieldKind::empty && kind != FieldKind::empty ? 1 : 0;
  }
  return settings >= 2;
}

/// Refuses a line directly above the table that begins as one of it, with words among its numbers
/// or another separator than the others.
void refuse_row_above(std::string_view bytes, const std::string& file, std::string_view line,
                      const CsvLayout& layout) {
  double value = 0;
  const auto columns = std::ssize(layout.columns);
  if (columns < 2 || parse_number(trim_blanks(line), '.', value) == 0) return;
  const auto refuse = [&](std::string_view text, const char* problem) {
    throw text_error(bytes, file, text, problem,
                     "correct the line, or delete it where it is none of the table");
  };
  for (const char separator : {';', '\t', '|', ',', ' '}) {
    if (separator != layout.dialect.separator &&
        Row(line, {separator, layout.dialect.decimal}).numbers == columns) {
      refuse(line, "is separated by another sign than the lines below");
    }
  }
  const Row row(line, layout.dialect);
  for (std::size_t c = 0; std::ssize(row.fields) == columns && c < row.fields.size(); ++c) {
    const auto text = row.fields[c].text;
    if (row.kind(c) == FieldKind::text && layout.columns[c].kind == FieldKind::number &&
        !is_unit_text(text)) {
      refuse(text, "is no number, in a line that seems to be one of the table");
    }
  }
}

}  // namespace

CsvLayout find_csv_layout(std::string_view bytes, const std::string& file,
                          const ReadOptions& options) {
  const auto no_table = [&](const char* why) {
    return RecordingError({file, 1, 1, "", ""}, why,
                          "give a table with one line a sample, columns separated by comma, "
                          "semicolon, tab or blanks");
  };
  const std::vector<std::string_view> sample = sample_lines(bytes);
  CsvLayout layout;
  std::vector<Row> rows = rows_of_best_dialect(sample, options, layout.dialect);
  if (rows.empty()) throw no_table("no table of numbers in this text");
  layout.columns = columns_of(rows);

  // The table begins at the first of three lines of numbers with no line of words between. Lines of
  // numbers above such a line are part of the header. A line of more words than numbers belongs to
  // a header; one with a wrong field does not.
  std::vector<std::string_view> header;
  std::size_t header_size = 0;
  int count = 0;
  for (std::string_view rest = bytes; !rest.empty() && count < 3;) {
    const std::size_t at = bytes.size() - rest.size();
    const auto line = take_line(rest);
    const Row row(line, layout.dialect);
    if (row.words > row.numbers) {
      if (count > 0 && rest.empty()) break;  // a word behind a short table
      count = 0;
    } else if (is_csv_row(line, layout) && count++ == 0) {
      layout.body = at;
      header_size = header.size();
    }
    header.push_back(line);
  }
  if (count == 0) throw no_table("no lines of numbers that follow each other");
  header.resize(header_size);
  // What the columns hold, lines of the header that look like rows do not say.
  rows = rows_of(sample_lines(bytes.substr(layout.body)), layout.dialect);
  layout.columns = columns_of(rows);
  while (!header.empty() && is_row_beside_settings(header.back(), layout)) {
    layout.body = static_cast<std::size_t>(header.back().data() - bytes.data());
    header.pop_back();
  }
  if (!header.empty()) refuse_row_above(bytes, file, header.back(), layout);
  for (std::size_t k = header.size(); k-- > 0; ++layout.numbers_above) {
    const Row row(header[k], layout.dialect);
    if (row.numbers == 0 || row.numbers < std::ssize(row.fields)) break;
  }
  layout.body_line = static_cast<long>(header.size()) + 1;
  if (layout.dialect.separator == ',' && layout.dialect.decimal == '.' && options.decimal == 0 &&
      options.separator == 0) {
    refuse_decimal_commas(rows, header, file, layout.dialect);
  }
  if (layout.dialect.separator == ',' && layout.dialect.decimal == ',' && options.decimal == 0) {
    refuse_thousands(rows, layout.body_line, file);
  }
  find_csv_decimals(bytes, layout);
  for (const auto& line : header) {
    if (layout.heading.size() < 4096) layout.heading += lower_case(to_utf8(line)) + '\n';
  }
  read_csv_header(header, bytes, file, options, layout);
  return layout;
}

void find_csv_decimals(std::string_view bytes, CsvLayout& layout) {
  const std::vector<std::string_view> sample = sample_lines(bytes.substr(layout.body));
  std::vector<long> looked_at(layout.columns.size());
  for (std::size_t k = sample.size(); k-- > 0;) {
    const Row row(sample[k], layout.dialect);
    for (std::size_t c = 0; c < std::min(row.fields.size(), looked_at.size()); ++c) {
      int decimals = 0;
      double seconds = 0;
      const bool is_number = row.kinds[c] == FieldKind::number;
      if (is_number) decimals = printed_decimals(row.fields[c].text, layout.dialect.decimal);
      if (!is_number && !parse_clock(row.fields[c].text, seconds, decimals)) continue;
      int& most = layout.columns[c].decimals;
      if (looked_at[c] < kSampledLines / 2)
        most = looked_at[c] == 0 ? decimals : std::max(most, decimals);
      ++looked_at[c];
    }
  }
}

}  // namespace rigfit::signal
