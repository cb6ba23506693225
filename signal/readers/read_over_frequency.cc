#include "signal/readers/read_over_frequency.h"

#include "signal/readers/read_recording.h"
#include "signal/readers/xlsx/read_xlsx.h"

namespace rigfit::signal {

std::optional<FrequencyTable> frequency_table_in(std::string_view bytes,
                                                 const std::filesystem::path& path,
                                                 const ReadOptions& options) {
  switch (format_of(bytes)) {
    case RecordingFormat::csv:
      return read_frequency_table(bytes, path, options);
    case RecordingFormat::xlsx:
      return frequency_table_of(read_xlsx_columns(path, options), path);
    default:
      return std::nullopt;
  }
}

}  // namespace rigfit::signal
