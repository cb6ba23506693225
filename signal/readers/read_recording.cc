#include "signal/readers/read_recording.h"

#include <algorithm>

#include "signal/readers/csv/csv_fields.h"
#include "signal/readers/csv/csv_layout.h"
#include "signal/readers/files/foreign_formats.h"
#include "signal/readers/files/mapped_file.h"
#include "signal/readers/files/read_formats.h"
#include "signal/readers/recording_description.h"
#include "signal/readers/uff/read_uff.h"
#include "signal/readers/xlsx/read_xlsx.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/recording_time.h"

namespace rigfit::signal {

namespace {

RecordingFormat format_named(const std::string& name, const std::string& file) {
  const auto names = format_names();
  const auto at = std::find(names.begin(), names.end(), name);
  if (at == names.end()) {
    throw RecordingError({file, 0, 0, "", name}, "no format of that name is read",
                         "csv (any table of text), lvm, uff, wav, npy, mat or xlsx");
  }
  return static_cast<RecordingFormat>(at - names.begin());  // in the order of the enumeration
}

}  // namespace

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

namespace {

Recording read_any(const std::filesystem::path& path, const ReadOptions& options,
                   const std::function<void(std::size_t)>& done_with) {
  const MappedFile file(path);
  const auto read_to = [&](std::size_t offset) {
    file.release_before(offset);
    if (done_with) done_with(offset);
  };
  if (options.format.empty()) {
    if (const auto foreign = foreign_format(file.bytes())) {
      throw RecordingError({path.string(), 0, 0, "", ""}, "is " + foreign->name, foreign->remedy);
    }
  }
  switch (options.format.empty() ? format_of(file.bytes())
                                 : format_named(options.format, path.string())) {
    case RecordingFormat::wav:
      return read_wav(file.bytes(), path, options, read_to);
    case RecordingFormat::npy:
      return read_npy(file.bytes(), path, options, read_to);
    case RecordingFormat::mat:
      return read_mat(path, options);
    case RecordingFormat::uff:
      return read_uff(file.bytes(), path, options, read_to);
    case RecordingFormat::lvm:
      return read_lvm(file.bytes(), path, options, read_to);
    case RecordingFormat::xlsx:
      return read_xlsx(path, options);
    case RecordingFormat::csv:
      break;
  }
  return read_csv(file.bytes(), path, options, read_to);
}

}  // namespace

Recording read_recording(const std::filesystem::path& path, const ReadOptions& options,
                         const std::function<void(std::size_t)>& done_with) {
  Recording recording = read_any(path, options, done_with);
  shorten(recording.notes);
  return recording;
}

}  // namespace rigfit::signal
