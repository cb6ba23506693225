#include "signal/readers/read_recording.h"

#include "signal/readers/csv/csv_fields.h"
#include "signal/readers/csv/csv_layout.h"
#include "signal/readers/csv/read_csv.h"
#include "signal/readers/mapped_file.h"
#include "signal/readers/read_lvm.h"
#include "signal/readers/uff/read_uff.h"

namespace rigfit::signal {

RecordingFormat format_of(std::string_view bytes) {
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
  const MappedFile file(path);
  switch (format_of(file.bytes())) {
    case RecordingFormat::uff:
      return read_uff(file.bytes(), path, options);
    case RecordingFormat::lvm:
      return read_lvm(file.bytes(), path, options);
    case RecordingFormat::csv:
      break;
  }
  return read_csv(file.bytes(), path, options,
                  [&](std::size_t offset) { file.release_before(offset); });
}

}  // namespace rigfit::signal
