#include "signal/readers/csv/read_csv.h"

#include <utility>

#include "signal/readers/csv/csv_columns.h"
#include "signal/readers/csv/table_recording.h"
#include "signal/readers/files/mapped_file.h"

namespace rigfit::signal {
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
  CsvTable csv = read_csv_columns(text, file, converted.empty() ? done_with : nullptr, options);
  return recording_of_table(std::move(csv), path, "csv", options);
}

}  // namespace rigfit::signal
