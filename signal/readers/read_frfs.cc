#include "signal/readers/read_frfs.h"

#include <utility>

#include "signal/readers/csv/frequency_table.h"
#include "signal/readers/files/mapped_file.h"
#include "signal/readers/files/read_formats.h"
#include "signal/readers/read_recording.h"
#include "signal/readers/uff/read_uff.h"
#include "signal/recording/recording_error.h"

namespace rigfit::signal {

FrfSet read_frfs(const std::vector<std::filesystem::path>& files, const ReadOptions& options) {
  std::vector<FrequencyTable> tables;
  for (const auto& path : files) {
    const MappedFile file(path);
    if (const auto foreign = foreign_format(file.bytes())) {
      throw file_error(path, "is " + foreign->name, foreign->remedy);
    }
    const RecordingFormat format = format_of(file.bytes());
    if (format == RecordingFormat::uff && files.size() == 1)
      return read_uff_frfs(file.bytes(), path);
    if (format == RecordingFormat::mat && files.size() == 1)
      return read_mat_frfs(file.bytes(), path, options);
    std::optional<FrequencyTable> table = frequency_table_in(file.bytes(), path, options);
    if (!table) {
      throw file_error(path,
                       format == RecordingFormat::uff ? "is one of several universal files"
                                                      : "is no table of FRFs over frequency",
                       "give one UFF file, text tables with frequency, real and imaginary "
                       "part; or recordings of hits, with --force CHANNEL");
    }
    tables.push_back(std::move(*table));
  }
  return frfs_of(tables);
}

std::optional<FrequencyTable> frequency_table_in(std::string_view bytes,
                                                 const std::filesystem::path& path,
                                                 const ReadOptions& options) {
  const RecordingFormat format = format_of(bytes);
  if (format == RecordingFormat::xlsx) {
    return frequency_table_of(read_xlsx_columns(path, options), path);
  }
  if (format != RecordingFormat::csv) return std::nullopt;
  std::string converted;
  const std::string file = path.string();
  return frequency_table_of(
      read_csv_columns(text_without_mark(bytes, converted, file), file, options), path);
}

}  // namespace rigfit::signal
