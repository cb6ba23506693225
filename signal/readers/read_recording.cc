#include "signal/readers/read_recording.h"

#include <algorithm>
#include <utility>

#include "signal/readers/csv/csv_fields.h"
#include "signal/readers/csv/frequency_table.h"
#include "signal/readers/files/mapped_file.h"
#include "signal/readers/files/read_formats.h"
#include "signal/readers/recording_description.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/recording_time.h"

namespace rigfit::signal {

RecordingFormat format_of(std::string_view bytes) {
  const auto magic = bytes.substr(0, 4);
  if ((magic == "RIFF" || magic == "RIFX" || magic == "RF64") && bytes.size() >= 12 &&
      bytes.substr(8, 4) == "WAVE") {
    return RecordingFormat::wav;
  }
  if (bytes.substr(0, 6) == "\x93NUMPY") return RecordingFormat::npy;
  if (bytes.substr(0, 6) == "MATLAB" && bytes.size() >= 128 &&
      (bytes.substr(126, 2) == "IM" || bytes.substr(126, 2) == "MI")) {
    return RecordingFormat::mat;
  }
  if (is_excel_workbook(bytes)) return RecordingFormat::xlsx;
  auto head = bytes.substr(0, 1024);
  if (head.substr(0, 3) == "\xEF\xBB\xBF") head.remove_prefix(3);
  std::size_t at = 0;
  while (at < head.size()) {
    const std::size_t end = line_end(head, at);
    const auto line = trim_blanks(head.substr(at, end - at));
    if (line == "-1") return RecordingFormat::uff;
    if (line.substr(0, 19) == "LabVIEW Measurement") return RecordingFormat::lvm;
    if (!line.empty()) break;
    at = next_line(head, end);
  }
  return RecordingFormat::csv;
}

Recording read_recording(const std::filesystem::path& path, const ReadOptions& options) {
  /// In the order of RecordingFormat, as format_names() gives them.
  constexpr decltype(&read_csv) kReaders[] = {read_csv, read_lvm, read_uff, read_wav,
                                              read_npy, read_mat, read_xlsx};
  const MappedFile file(path);
  auto format = static_cast<std::size_t>(format_of(file.bytes()));
  if (!options.format.empty()) {
    const auto names = format_names();
    const auto at = std::find(names.begin(), names.end(), options.format);
    if (at == names.end()) {
      throw file_error(path, "no format of that name is read",
                       "csv (any table of text), lvm, uff, wav, npy, mat or xlsx", options.format);
    }
    format = static_cast<std::size_t>(at - names.begin());
  } else if (const auto foreign = foreign_format(file.bytes())) {
    throw file_error(path, "is " + foreign->name, foreign->remedy);
  }
  ReadOptions releasing = options;
  releasing.done_with = [&](std::size_t offset) {
    file.release_before(offset);
    if (options.done_with) options.done_with(offset);
  };
  Recording recording = kReaders[format](file.bytes(), path, releasing);
  shorten(recording.notes);
  return recording;
}

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
