#include "signal/readers/csv/read_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "signal/readers/csv/csv_columns.h"
#include "signal/readers/csv/csv_time.h"
#include "signal/readers/mapped_file.h"
#include "signal/recording/recording_error.h"

namespace rigfit::signal {
namespace {

std::string join(const std::vector<std::string>& names) {
  std::string out;
  for (const auto& name : names) out += (out.empty() ? "\"" : ", \"") + name + "\"";
  return out;
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
  CsvTable csv =
      read_csv_columns(text_without_mark(bytes, converted, path.string()), path.string(), {});
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
  const std::string_view text = text_without_mark(bytes, converted, file);
  CsvTable csv = 
      read_csv_columns(text, file, converted.empty() ? done_with : nullptr, options);
  const CsvLayout& layout = csv.layout;

  Recording recording;
  recording.path = path;
  recording.format = "csv";
  recording.notes = std::move(csv.notes);

  const std::vector<std::size_t> left_out = 
      take_csv_times(csv, file, recording, options);
  if (recording.sample_rate_hz == 0) recording.sample_rate_hz = layout.stated_rate_hz;
  if (options.sample_rate_hz > 0) {
    const double had = recording.sample_rate_hz;
    if (had > 0 && std::abs(had / options.sample_rate_hz - 1) > 1e-4) {
      recording.notes.push_back({"rate_overridden",
                                 "the file gives " + fmt::format("{:.9g}", had) + " Hz; " +
                                     fmt::format("{:.9g}", options.sample_rate_hz) +
                                     " Hz is taken as asked",
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
