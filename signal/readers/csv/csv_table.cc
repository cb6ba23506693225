#include "signal/readers/csv/csv_table.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "signal/readers/csv/csv_time.h"
#include "signal/readers/csv/frequency_table.h"
#include "signal/readers/csv/read_csv.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/recording_time.h"

namespace rigfit::signal {

Recording recording_of_table(CsvTable csv, const std::filesystem::path& path,
                             const std::string& format, const ReadOptions& options) {
  const CsvLayout& layout = csv.layout;
  const std::string file = path.string();
  if (frequency_column(csv)) {
    throw RecordingError(
        {file, layout.body_line, 0, csv.channels[*frequency_column(csv)].name, ""},
        "is a spectrum or FRF over frequency, not a recording over time",
        "rigfit inspect lists a spectrum's peaks, rigfit modal takes FRFs; for a decay or hits "
        "export the time signal. Where the first column is time after all, title it so");
  }

  const std::string spectrum = spectrum_without_frequencies(csv);
  if (!spectrum.empty() && options.format.empty()) {
    throw RecordingError(
        {file, layout.body_line, 0, spectrum, ""},
        "is a spectrum by its title, without a column of frequencies; not taken as a recording "
        "over time",
        "export it with its frequencies (rigfit inspect then lists the peaks), or export the time "
        "signal; where it is a time signal after all: --format " +
            format);
  }

  Recording recording;
  recording.path = path;
  recording.format = format;
  recording.notes = std::move(csv.notes);

  const std::vector<std::size_t> left_out = take_csv_times(csv, file, recording, options);
  if (recording.sample_rate_hz == 0) recording.sample_rate_hz = layout.stated_rate_hz;
  take_stated_rate(options.sample_rate_hz, recording);
  if (recording.sample_rate_hz == 0) {
    recording.notes.push_back({"no_sample_rate",
                               "neither times nor a sample rate in the file: give the rate (option "
                               "or sample_rate_hz in the TOML file beside the recording)",
                               ""});
  }
  for (std::size_t k = 0; k < csv.channels.size(); ++k) {
    if (std::find(left_out.begin(), left_out.end(), k) != left_out.end()) continue;
    if (layout.has_names && layout.columns[csv.column[k]].name.empty()) {
      recording.notes.push_back({"read_as", "has no title in the header", csv.channels[k].name});
    }
    recording.channels.push_back(std::move(csv.channels[k]));
  }
  if (recording.channels.empty()) {
    throw RecordingError({file, layout.body_line, 0, "", ""},
                         "holds times but no channel beside them",
                         "give a recording with at least one channel");
  }
  note_unitless(recording);
  return recording;
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
