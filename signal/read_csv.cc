#include "signal/read_csv.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

#include "signal/csv_body.h"
#include "signal/csv_layout.h"
#include "signal/mapped_file.h"
#include "signal/recording_error.h"
#include "signal/time_axis.h"
#include "signal/units.h"

namespace rigfit::signal {
namespace {

struct CsvTable {
  CsvLayout layout;
  std::vector<Channel> channels;
  std::vector<std::size_t> column;  ///< of each channel in the file
  std::vector<int> decimals;
  std::vector<Note> notes;
};

std::string decimal_text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return text.data();
}

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

/// UTF-16 with a byte-order mark as UTF-8; characters beyond the basic plane become '?'.
std::string from_utf16(std::string_view bytes) {
  const bool little = static_cast<unsigned char>(bytes[0]) == 0xFF;
  std::string out;
  out.reserve(bytes.size() / 2);
  for (std::size_t i = 2; i + 1 < bytes.size(); i += 2) {
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

/// Text without its byte-order mark; UTF-16 is put into `converted`.
std::string_view without_mark(std::string_view bytes, std::string& converted,
                              const std::string& file) {
  if (bytes.size() >= 2 && (bytes.substr(0, 2) == "\xFF\xFE" || bytes.substr(0, 2) == "\xFE\xFF")) {
    converted = from_utf16(bytes);
    return converted;
  }
  if (bytes.substr(0, 3) == "\xEF\xBB\xBF") bytes.remove_prefix(3);
  const auto head = bytes.substr(0, 4096);
  if (const auto nul = head.find('\0'); nul != std::string_view::npos) {
    throw RecordingError({file, line_number(bytes, nul), 0, "", ""},
                         "holds binary data where text was expected",
                         "export the recording as CSV, UFF 58 or LVM");
  }
  return bytes;
}

CsvTable read_columns(std::string_view bytes, const std::string& file,
                      const std::function<void(std::size_t)>& done_with) {
  CsvTable table;
  table.layout = find_csv_layout(bytes, file);
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

  // Columns that looked empty in the lines looked at but hold something are stray, too.
  std::vector<std::size_t> unnamed = stray;
  unnamed.insert(unnamed.end(), nothing.begin(), nothing.end());
  std::sort(unnamed.begin(), unnamed.end());
  if (!unnamed.empty()) {
    const std::string found = what_is_in(bytes, layout, unnamed);
    table.notes.push_back(
        {"columns_left_out",
         columns_text(unnamed) +
             (found.empty() ? " without name or numbers: left out"
                            : " without a name, filled in few lines (" + found + "): left out"),
         ""});
  }
  for (const std::size_t c : words) {
    table.notes.push_back({"text_column_left_out",
                           "column " + std::to_string(c + 1) + " holds words (" +
                               what_is_in(bytes, layout, {c}) + "): left out",
                           layout.columns[c].name});
  }
  if (body.short_rows > 0) {
    table.notes.push_back({"short_rows",
                           std::to_string(body.short_rows) +
                               " lines have fewer fields than the table has columns; what is "
                               "absent counts as missing",
                           ""});
  }
  if (body.comment_lines > 0) {
    table.notes.push_back({"comments_skipped",
                           std::to_string(body.comment_lines) + " comment lines inside the table "
                                                                "skipped",
                           ""});
  }
  if (body.footer_line > 0) {
    table.notes.push_back({"footer_skipped", "text behind the table skipped",
                           "line " + std::to_string(body.footer_line)});
  }
  if (body.incomplete_last) {
    table.notes.push_back(
        {"incomplete_last_line", "the last line broke off before its end and is left out", ""});
  }
  if (body.empty_rows_at_end > 0) {
    table.notes.push_back(
        {"empty_rows_left_out",
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
    for (int k = 2; !used.insert(channel.name).second; ++k) {
      channel.name = first + "_" + std::to_string(k);
    }
    if (channel.name != first) {
      table.notes.push_back(
          {"duplicate_name",
           "a second column named \"" + first + "\" is called \"" + channel.name + "\" here",
           channel.name});
    }
    channel.source_unit = column.unit;
    if (column.kind == ColumnKind::clock) {
      channel.unit = "s";
      channel.quantity = Quantity::time;
    } else if (const auto unit = parse_unit(column.unit)) {
      channel.unit = unit->si;
      channel.si_per_source = unit->factor;
      channel.si_offset = unit->offset;
      channel.quantity = unit->quantity;
    } else if (!column.unit.empty()) {
      table.notes.push_back({"unknown_unit",
                             "unit \"" + column.unit +
                                 "\" is not known: the numbers are kept as "
                                 "they are",
                             channel.name});
    }
    channel.nominal_range = column.range * channel.si_per_source;
    channel.samples = std::move(body.columns[c]);
    if (channel.si_per_source != 1) channel.samples *= channel.si_per_source;
    if (channel.si_offset != 0) channel.samples.array() += channel.si_offset;
    channel.missing_samples = body.missing[c];
    double largest = 0;
    for (const double x : channel.samples) {
      if (std::abs(x) > largest) largest = std::abs(x);
    }
    if (channel.nominal_range > 0 && largest > 1.1 * channel.nominal_range) {
      table.notes.push_back({"range_not_used",
                             "the header's range of " + decimal_text(column.range) +
                                 " is exceeded by the numbers and seems not to be in the "
                                 "channel's unit: not used",
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

bool is_time_name(const std::string& name) {
  const std::string word = lower_case(name);
  static constexpr std::array<std::string_view, 30> kWords = {"t",
                                                              "time",
                                                              "zeit",
                                                              "temps",
                                                              "tiempo",
                                                              "tempo",
                                                              "tid",
                                                              "sec",
                                                              "secs",
                                                              "second",
                                                              "seconds",
                                                              "s",
                                                              "ms",
                                                              "msec",
                                                              "elapsed",
                                                              "timestamp",
                                                              "clock",
                                                              "uhrzeit",
                                                              "datetime",
                                                              "date/time",
                                                              "date time",
                                                              "x_value",
                                                              "x value",
                                                              "time_s",
                                                              "elapsed time",
                                                              "t_s",
                                                              "relative time",
                                                              "time stamp",
                                                              "rel time",
                                                              "time_ms"};
  if (std::find(kWords.begin(), kWords.end(), word) != kWords.end()) return true;
  for (const std::string_view stem : {"time", "zeit", "elapsed", "timestamp"}) {
    if (word.size() > stem.size() && word.compare(0, stem.size(), stem) == 0 &&
        std::isalpha(static_cast<unsigned char>(word[stem.size()])) == 0) {
      return true;
    }
  }
  return word.size() > 5 && word.compare(word.size() - 5, 5, " time") == 0;
}

bool is_index_name(const std::string& name) {
  const std::string word = lower_case(name);
  static constexpr std::array<std::string_view, 17> kWords = {
      "sample", "samples", "index", "no",  "no.",    "nr",        "nr.",        "#",
      "n",      "scan",    "point", "row", "record", "sample no", "sample no.", "sample number",
      "count"};
  return std::find(kWords.begin(), kWords.end(), word) != kWords.end();
}

/// 0, 1, 2 ... (or from 1), in steps of exactly one.
bool counts_samples(const Eigen::VectorXd& values) {
  if (values.size() < 2 || std::abs(values[0]) > 1 || values[0] != std::floor(values[0])) {
    return false;
  }
  for (Eigen::Index k = 1; k < values.size(); ++k) {
    if (values[k] - values[k - 1] != 1) return false;
  }
  return true;
}

/// Every time the same step within printing, over at least three samples.
bool looks_like_time(const Eigen::VectorXd& values, int decimals) {
  if (values.size() < 3 || !values.allFinite()) return false;
  TimeAxisOptions options;
  options.printed_resolution_s = std::pow(10.0, -decimals);
  const TimeAxis axis = time_axis(values, options);
  return axis.uniform && axis.rate_hz > 0 && values[1] > values[0];
}

std::string join(const std::vector<std::string>& names) {
  std::string out;
  for (const auto& name : names) out += (out.empty() ? "\"" : ", \"") + name + "\"";
  return out;
}

void note_time_faults(const TimeAxis& axis, const CsvLayout& layout, double resolution,
                      Recording& recording) {
  const auto line = [&](Eigen::Index sample) {
    return "near line " + std::to_string(layout.body_line + static_cast<long>(sample));
  };
  if (axis.backward > 0 || axis.repeated > 0) {
    recording.notes.push_back({"time_not_rising",
                               "times go back " + std::to_string(axis.backward) +
                                   " times and repeat " + std::to_string(axis.repeated) + " times",
                               line(axis.first_fault)});
  }
  if (axis.gaps > 0) {
    recording.notes.push_back({"time_gaps",
                               std::to_string(axis.gaps) + " gaps in the times, the longest " +
                                   decimal_text(axis.longest_gap_s) + " s",
                               line(axis.longest_gap_at)});
  }
  if (axis.missing > 0) {
    recording.notes.push_back(
        {"time_missing", std::to_string(axis.missing) + " times are missing", ""});
  }
  if (!axis.uniform && axis.rate_hz > 0) {
    recording.notes.push_back(
        {"time_not_uniform",
         "sampling is not uniform (rms departure " + decimal_text(axis.jitter_s) + " s)", ""});
  } else if (axis.rate_hz > 0 && resolution * axis.rate_hz > 1) {
    recording.notes.push_back({"time_rounded",
                               "times are printed to " + decimal_text(resolution) +
                                   " s, coarser than the sampling step; the rate is that of the "
                                   "whole record",
                               ""});
  }
}

}  // namespace

Eigen::Index Table::column_index(const std::string& name) const {
  Recording as_recording;
  as_recording.path = path;
  for (const auto& column : columns) {
    Channel channel;
    channel.name = column.name;
    as_recording.channels.push_back(std::move(channel));
  }
  return as_recording.channel_index(name);
}

Table read_table(std::string_view bytes, const std::filesystem::path& path) {
  std::string converted;
  CsvTable csv = read_columns(without_mark(bytes, converted, path.string()), path.string(), {});
  Table table;
  table.path = path;
  table.columns = std::move(csv.channels);
  table.notes = std::move(csv.notes);
  return table;
}

Table read_table(const std::filesystem::path& path) {
  const MappedFile file(path);
  return read_table(file.bytes(), path);
}

Recording read_csv(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options, const std::function<void(std::size_t)>& done_with) {
  const std::string file = path.string();
  std::string converted;
  const std::string_view text = without_mark(bytes, converted, file);
  CsvTable csv = read_columns(text, file, converted.empty() ? done_with : nullptr);
  const CsvLayout& layout = csv.layout;

  Recording recording;
  recording.path = path;
  recording.format = "csv";
  recording.notes = std::move(csv.notes);

  // Which column is the time?
  std::optional<std::size_t> time;
  const auto kind = [&](std::size_t k) { return layout.columns[csv.column[k]].kind; };
  for (std::size_t k = 0; k < csv.channels.size() && !time; ++k) {
    const Channel& channel = csv.channels[k];
    if (kind(k) == ColumnKind::empty) continue;
    if (kind(k) == ColumnKind::clock ||
        (is_time_name(channel.name) &&
         (channel.source_unit.empty() || channel.quantity == Quantity::time))) {
      time = k;
    }
  }
  const bool first_unnamed =
      !csv.channels.empty() && layout.columns[csv.column[0]].name.empty() && csv.column[0] == 0;
  std::vector<std::size_t> left_out;
  if (!time && csv.channels.size() > 1) {
    Channel& first = csv.channels[0];
    if ((first_unnamed || is_index_name(first.name)) && counts_samples(first.samples)) {
      left_out.push_back(0);
      recording.notes.push_back(
          {"index_column_left_out", "counts the samples: left out", first.name});
    } else if ((first_unnamed || first.quantity == Quantity::time) &&
               looks_like_time(first.samples, csv.decimals[0])) {
      time = 0;
      if (first.source_unit.empty() && !layout.has_names) {
        recording.notes.push_back(
            {"time_column_assumed", "column 1 rises in equal steps: taken as time in seconds", ""});
      }
    }
  }

  double printed = 0;
  if (time) {
    Channel& column = csv.channels[*time];
    TimeAxisOptions axis_options;
    printed = std::pow(10.0, -csv.decimals[*time]) * std::abs(column.si_per_source);
    axis_options.printed_resolution_s = printed;
    axis_options.stated_rate_hz = layout.stated_rate_hz;
    if (kind(*time) == ColumnKind::clock) {
      // Midnight inside the record.
      for (Eigen::Index k = 1; k < column.samples.size(); ++k) {
        if (column.samples[k] - column.samples[k - 1] < -43200) {
          column.samples.tail(column.samples.size() - k).array() += 86400;
        }
      }
      const double start = column.samples[0];
      if (std::isfinite(start)) column.samples.array() -= start;
    }
    const TimeAxis axis = time_axis(column.samples, axis_options);
    recording.sample_rate_hz = axis.rate_hz;
    recording.start_time_s = axis.start_s;
    recording.time_jitter_s = axis.jitter_s;
    note_time_faults(axis, layout, printed, recording);
    if (!axis.agrees_with_stated && axis.rate_hz > 0) {
      recording.notes.push_back({"rate_disagrees",
                                 "the times give " + decimal_text(axis.rate_hz) +
                                     " Hz, the header says " + decimal_text(layout.stated_rate_hz) +
                                     " Hz (\"" + layout.rate_text + "\"): the times are taken",
                                 "line " + std::to_string(layout.rate_line)});
    }
    if (!axis.uniform && axis.rate_hz > 0) {
      if (axis.missing > 0) {
        Eigen::Index at = 0;
        while (at < column.samples.size() && std::isfinite(column.samples[at])) ++at;
        throw RecordingError({file, layout.body_line + static_cast<long>(at), 0, column.name, ""},
                             "the time is missing and sampling is not uniform",
                             "mend the times, or delete that column and give the sample rate");
      }
      recording.time_s = column.samples;
    }
    if (axis.rate_hz == 0 && column.samples.size() > 1) {
      recording.notes.push_back(
          {"time_unusable", "the times do not rise: no sample rate from them", column.name});
    }
    left_out.push_back(*time);
    // LabVIEW and others repeat the time for each channel.
    for (std::size_t k = 0; k < csv.channels.size(); ++k) {
      if (k == *time || kind(k) == ColumnKind::empty) continue;
      Channel& other = csv.channels[k];
      const std::string& title = layout.columns[csv.column[k]].name;
      if (other.quantity != Quantity::time && !is_time_name(title)) continue;
      if ((other.samples - column.samples).cwiseAbs().maxCoeff() <= printed) {
        left_out.push_back(k);
        recording.notes.push_back(
            {"repeated_time_column", "the same times once more: left out", other.name});
      }
    }
  }
  if (recording.sample_rate_hz == 0) recording.sample_rate_hz = layout.stated_rate_hz;
  if (options.sample_rate_hz > 0) {
    const double had = recording.sample_rate_hz;
    if (had > 0 && std::abs(had / options.sample_rate_hz - 1) > 1e-4) {
      recording.notes.push_back({"rate_overridden",
                                 "the file gives " + decimal_text(had) + " Hz; " +
                                     decimal_text(options.sample_rate_hz) + " Hz is taken as asked",
                                 ""});
      recording.time_s.resize(0);
    }
    recording.sample_rate_hz = options.sample_rate_hz;
  }
  if (recording.sample_rate_hz == 0) {
    recording.notes.push_back({"no_sample_rate",
                               "neither times nor a sample rate in the file: give the rate (option "
                               "or sample_rate_hz in the TOML file beside the recording)",
                               ""});
  }
  std::vector<std::string> unitless;
  for (std::size_t k = 0; k < csv.channels.size(); ++k) {
    if (std::find(left_out.begin(), left_out.end(), k) != left_out.end()) continue;
    if (layout.has_names && layout.columns[csv.column[k]].name.empty()) {
      recording.notes.push_back(
          {"unnamed_column", "has no title in the header", csv.channels[k].name});
    }
    if (csv.channels[k].source_unit.empty()) unitless.push_back(csv.channels[k].name);
    recording.channels.push_back(std::move(csv.channels[k]));
  }
  if (recording.channels.empty()) {
    throw RecordingError({file, layout.body_line, 0, "", ""},
                         "holds times but no channel beside them",
                         "give a recording with at least one channel");
  }
  if (!unitless.empty()) {
    recording.notes.push_back(
        {"no_unit", "no unit in the file: the numbers are kept as they are", join(unitless)});
  }
  return recording;
}

}  // namespace rigfit::signal
