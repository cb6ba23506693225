#include "signal/readers/csv/read_csv.h"

#include <utility>

#include "signal/readers/csv/csv_columns.h"
#include "signal/readers/csv/table_recording.h"

namespace rigfit::signal {

Recording read_csv(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options, const std::function<void(std::size_t)>& done_with) {
  const std::string file = path.string();
  std::string converted;
  const std::string_view text = text_without_mark(bytes, converted, file);
  CsvTable csv = read_csv_columns(text, file, converted.empty() ? done_with : nullptr, options);
  return recording_of_table(std::move(csv), path, "csv", options);
}

}  // namespace rigfit::signal
