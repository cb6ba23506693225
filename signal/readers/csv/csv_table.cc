#include "signal/readers/csv/csv_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "signal/recording/recording_error.h"
#include "signal/recording/recording_time.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

using Places = std::vector<std::size_t>;

/// "3", "3 to 5", "3 and 5".
std::string columns_text(const Places& columns) {
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
std::string what_is_in(std::string_view body, const CsvDialect& dialect, const Places& columns) {
  std::string found;
  int words = 0;
  std::vector<CsvField> fields;
  for (int line = 0; line < 100 && !body.empty(); ++line) {
    split_fields(take_line(body), dialect, fields);
    for (const std::size_t c : columns) {
      if (c >= fields.size() || fields[c].text.empty() || words == 4) continue;
      found += (words++ > 0 ? ", \"" : "\"") + to_utf8(fields[c].text.substr(0, 40)) + "\"";
    }
  }
  return found;
}

void note_body(const CsvBody& body, std::vector<Note>& notes) {
  const auto note = [&](long count, const char* code, const std::string& message,
                        const std::string& where = "") {
    if (count > 0) notes.push_back({code, message, where});
  };
  note(body.short_rows, "incomplete",
       fmt::format("{} lines have fewer fields than the table has columns; what is absent counts "
                   "as missing",
                   body.short_rows));
  note(body.comment_lines, "left_out",
       fmt::format("{} comment lines inside the table skipped", body.comment_lines));
  note(body.footer_line, "left_out", "text behind the table skipped",
       fmt::format("line {}", body.footer_line));
  note(body.incomplete_last ? 1 : 0, "incomplete",
       "the last line broke off before its end and is left out");
  note(body.empty_rows_at_end, "left_out",
       fmt::format("{} rows without any number at the end left out", body.empty_rows_at_end));
}

Channel channel_of(const CsvColumn& column, std::size_t place, Eigen::VectorXd numbers,
                   std::set<std::string>& used, std::vector<Note>& notes) {
  Channel channel;
  const std::string first =
      column.name.empty() ? "column " + std::to_string(place + 1) : column.name;
  channel.name = unused_name(first, used);
  if (channel.name != first) {
    notes.push_back(
        {"duplicate_name",
         "a second column named \"" + first + "\" is called \"" + channel.name + "\" here",
         channel.name});
  }
  if (column.kind == ColumnKind::clock) {
    channel.source_unit = column.unit;
    channel.unit = "s";
    channel.quantity = Quantity::time;
  } else {
    take_unit(column.unit, channel, notes);
  }
  channel.nominal_range = column.range * channel.si_per_source;
  take_samples(std::move(numbers), channel);
  if (channel.nominal_range > 0 &&
      (channel.samples.array().abs() > 1.1 * channel.nominal_range).any()) {
    notes.push_back({"left_out",
                     fmt::format("Check the unit: the numbers exceed the header's range of "
                                 "{:.9g}, which is not used",
                                 column.range),
                     channel.name});
    channel.nominal_range = 0;
  }
  if (channel.missing_samples == channel.samples.size()) {
    notes.push_back({"no_samples", "holds no number at all", channel.name});
  }
  return channel;
}

}  // namespace

CsvTable read_csv_columns(std::string_view bytes, const std::string& file,
                          const std::function<void(std::size_t)>& done_with,
                          const ReadOptions& options) {
  CsvTable table;
  table.file = file;
  table.layout = find_csv_layout(bytes, file, options);
  const CsvLayout& layout = table.layout;
  const std::size_t n = layout.columns.size();
  std::vector<bool> wanted(n, false);
  Places unnamed, words;
  for (std::size_t c = 0; c < n; ++c) {
    const CsvColumn& column = layout.columns[c];
    const bool named = !column.name.empty();
    // Without a name among named ones, and mostly empty: somebody's side calculation.
    wanted[c] = column.has_data() ? named || !layout.has_names || column.filled >= 0.5
                                  : named && column.kind == ColumnKind::empty;
    if (!wanted[c]) (named ? words : unnamed).push_back(c);
  }
  CsvBody body = parse_csv_body(bytes, layout, wanted, file, done_with);
  if (body.rows == 0) {
    throw RecordingError({file, layout.body_line, 0, "", ""}, "the table holds no numbers",
                         "check the recording");
  }

  const auto holds = [&](const Places& columns) {
    return what_is_in(bytes.substr(layout.body), layout.dialect, columns);
  };
  if (!layout.unmatched_titles.empty()) {
    table.notes.push_back(
        {"titles_not_matched",
         fmt::format("the titles \"{}\" do not part into {} columns: columns are named by their "
                     "number; part the titles by tabs, or name channels in a TOML file",
                     layout.unmatched_titles, n),
         ""});
  }
  if (!unnamed.empty()) {
    const std::string found = holds(unnamed);
    table.notes.push_back(
        {"left_out",
         columns_text(unnamed) +
             (found.empty() ? " without name or numbers: left out"
                            : " without a name, filled in few lines (" + found + "): left out"),
         ""});
  }
  for (const std::size_t c : words) {
    table.notes.push_back({"left_out",
                           fmt::format("column {} holds words ({}): left out", c + 1, holds({c})),
                           layout.columns[c].name});
  }
  note_body(body, table.notes);
  std::set<std::string> used;
  for (std::size_t c = 0; c < n; ++c) {
    if (!wanted[c]) continue;
    table.channels.push_back(
        channel_of(layout.columns[c], c, std::move(body.columns[c]), used, table.notes));
    table.column.push_back(c);
  }
  return table;
}

}  // namespace rigfit::signal
