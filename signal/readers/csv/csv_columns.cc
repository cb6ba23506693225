#include "signal/readers/csv/csv_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "signal/readers/csv/csv_body.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/recording_time.h"
#include "signal/recording/units.h"

namespace rigfit::signal {

namespace {

/// "3", "3 to 5", "3 and 5".
std::string columns_text(const std::vector<std::size_t>& columns) {
  std::string out;
  for (std::size_t i = 0; i < columns.size();) {
    std::size_t j = i;
    while (j + 1 < columns.size() && columns[j + 1] == columns[j] + 1) ++j;
    if (!out.empty()) out += ", ";
    out += std::to_string(columns[i] + 1);
    if (j > i) out += (j == i + 1 ? " and " : " to ") + std::to_string(columns[j] + 1);
    i = j + 1;
  }
  return (columns.size() == 1 ? "column " : "columns ") + out;
}

/// The first few things that the left-out columns hold, for the note.
std::string what_is_in(std::string_view bytes, const CsvLayout& layout,
                       const std::vector<std::size_t>& columns) {
  std::string found;
  int words = 0;
  std::vector<CsvField> fields;
  std::size_t at = layout.body;
  for (int line = 0; line < 100 && at < bytes.size() && words < 4; ++line) {
    const std::size_t end = line_end(bytes, at);
    split_fields(bytes.substr(at, end - at), layout.dialect, fields);
    for (const std::size_t c : columns) {
      if (c >= fields.size() || fields[c].text.empty() || words == 4) continue;
      found += (words++ > 0 ? ", \"" : "\"") + to_utf8(fields[c].text.substr(0, 40)) + "\"";
    }
    at = next_line(bytes, end);
  }
  return found;
}

/// UTF-16 as UTF-8; characters beyond the basic plane become '?'.
std::string from_utf16(std::string_view bytes, bool little) {
  std::string out;
  out.reserve(bytes.size() / 2);
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const auto low = static_cast<unsigned char>(bytes[little ? i : i + 1]);
    const auto high = static_cast<unsigned char>(bytes[little ? i + 1 : i]);
    const unsigned code = static_cast<unsigned>(high) << 8 | low;
    if (code < 0x80) {
      out += static_cast<char>(code);
    } else if (code < 0x800) {
      out += static_cast<char>(0xC0 | code >> 6);
      out += static_cast<char>(0x80 | (code & 0x3F));
    } else if (code >= 0xD800 && code < 0xE000) {
      out += '?';
    } else {
      out += static_cast<char>(0xE0 | code >> 12);
      out += static_cast<char>(0x80 | (code >> 6 & 0x3F));
      out += static_cast<char>(0x80 | (code & 0x3F));
    }
  }
  return out;
}

}  // namespace

std::string_view text_without_mark(std::string_view bytes, std::string& converted,
                                   const std::string& file) {
  if (bytes.size() >= 2 && (bytes.substr(0, 2) == "\xFF\xFE" || bytes.substr(0, 2) == "\xFE\xFF")) {
    converted = from_utf16(bytes.substr(2), bytes[0] == '\xFF');
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
    converted = from_utf16(bytes, zeros[1] > 0);
    return converted;
  }
  if (const auto nul = head.find('\0'); nul != std::string_view::npos) {
    throw RecordingError({file, line_number(bytes, nul), 0, "", ""},
                         "holds binary data where text was expected",
                         "export the recording as CSV, UFF 58 or LVM");
  }
  return bytes;
}

CsvTable read_csv_columns(std::string_view bytes, const std::string& file,
                          const std::function<void(std::size_t)>& done_with,
                          const ReadOptions& options) {
  CsvTable table;
  table.file = file;
  table.layout = find_csv_layout(bytes, file, options);
  const CsvLayout& layout = table.layout;
  const std::size_t n = layout.columns.size();
  std::vector<bool> wanted(n, false);
  std::vector<std::size_t> stray, words, nothing;
  for (std::size_t c = 0; c < n; ++c) {
    const CsvColumn& column = layout.columns[c];
    const bool named = !column.name.empty();
    switch (column.kind) {
      case ColumnKind::numbers:
      case ColumnKind::clock:
        // Without a name among named ones, and mostly empty: somebody's side calculation.
        wanted[c] = named || !layout.has_names || column.filled >= 0.5;
        if (!wanted[c]) stray.push_back(c);
        break;
      case ColumnKind::text:
        (named ? words : stray).push_back(c);
        break;
      case ColumnKind::empty:
        wanted[c] = named;
        if (!named) nothing.push_back(c);
        break;
    }
  }
  CsvBody body = parse_csv_body(bytes, layout, wanted, file, done_with);
  if (body.rows == 0) {
    throw RecordingError({file, layout.body_line, 0, "", ""}, "the table holds no numbers",
                         "check the recording");
  }

  if (!layout.unmatched_titles.empty()) {
    table.notes.push_back({"titles_not_matched",
                           "the titles \"" + layout.unmatched_titles + "\" do not part into " +
                               std::to_string(n) +
                               " columns: columns are named by their number; part the titles by "
                               "tabs, or name channels in a TOML file",
                           ""});
  }
  // Columns that looked empty in the lines looked at but hold something are stray, too.
  std::vector<std::size_t> unnamed = stray;
  unnamed.insert(unnamed.end(), nothing.begin(), nothing.end());
  std::sort(unnamed.begin(), unnamed.end());
  if (!unnamed.empty()) {
    const std::string found = what_is_in(bytes, layout, unnamed);
    table.notes.push_back(
        {"left_out",
         columns_text(unnamed) +
             (found.empty() ? " without name or numbers: left out"
                            : " without a name, filled in few lines (" + found + "): left out"),
         ""});
  }
  for (const std::size_t c : words) {
    table.notes.push_back({"left_out",
                           "column " + std::to_string(c + 1) + " holds words (" +
                               what_is_in(bytes, layout, {c}) + "): left out",
                           layout.columns[c].name});
  }
  if (body.short_rows > 0) {
    table.notes.push_back({"incomplete",
                           std::to_string(body.short_rows) +
                               " lines have fewer fields than the table has columns; what is "
                               "absent counts as missing",
                           ""});
  }
  if (body.comment_lines > 0) {
    table.notes.push_back({"left_out",
                           std::to_string(body.comment_lines) + " comment lines inside the table "
                                                                "skipped",
                           ""});
  }
  if (body.footer_line > 0) {
    table.notes.push_back(
        {"left_out", "text behind the table skipped", "line " + std::to_string(body.footer_line)});
  }
  if (body.incomplete_last) {
    table.notes.push_back(
        {"incomplete", "the last line broke off before its end and is left out", ""});
  }
  if (body.empty_rows_at_end > 0) {
    table.notes.push_back(
        {"left_out",
         std::to_string(body.empty_rows_at_end) + " rows without any number at the end left out",
         ""});
  }

  std::set<std::string> used;
  for (std::size_t c = 0; c < n; ++c) {
    if (!wanted[c]) continue;
    const CsvColumn& column = layout.columns[c];
    Channel channel;
    channel.name = column.name.empty() ? "column " + std::to_string(c + 1) : column.name;
    const std::string first = channel.name;
    channel.name = unused_name(first, used);
    if (channel.name != first) {
      table.notes.push_back(
          {"duplicate_name",
           "a second column named \"" + first + "\" is called \"" + channel.name + "\" here",
           channel.name});
    }
    if (column.kind == ColumnKind::clock) {
      channel.source_unit = column.unit;
      channel.unit = "s";
      channel.quantity = Quantity::time;
    } else {
      take_unit(column.unit, channel, table.notes);
    }
    channel.nominal_range = column.range * channel.si_per_source;
    take_samples(std::move(body.columns[c]), channel);
    if (channel.nominal_range > 0 &&
        (channel.samples.array().abs() > 1.1 * channel.nominal_range).any()) {
      table.notes.push_back({"left_out",
                             "Check the unit: the numbers exceed the header's range of " +
                                 fmt::format("{:.9g}", column.range) + ", which is not used",
                             channel.name});
      channel.nominal_range = 0;
    }
    if (channel.missing_samples == body.rows) {
      table.notes.push_back({"no_samples", "holds no number at all", channel.name});
    }
    table.channels.push_back(std::move(channel));
    table.column.push_back(c);
    table.decimals.push_back(body.decimals[c]);
  }
  return table;
}

}  // namespace rigfit::signal
