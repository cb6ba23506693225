#include "apps/campaign_file/recording_description.h"

#include <fmt/format.h>

#include <system_error>
#include <vector>

#include "apps/cli/at_hand.h"
#include "apps/cli/progress.h"
#include "signal/readers/csv/frequency_table.h"
#include "signal/readers/files/mapped_file.h"
#include "signal/readers/files/read_formats.h"
#include "signal/readers/read_recording.h"
#include "signal/recording/recording_time.h"

namespace rigfit::apps {
namespace fs = std::filesystem;

signal::Recording load_untold(const fs::path& path, VerbContext& context,
                              const RecordingDescription& given) {
  if (const auto known = recording_at_hand(path.string(), context)) {
    signal::Recording copy = *known;
    if (!(copy.sample_rate_hz > 0)) copy.sample_rate_hz = context.reading.sample_rate_hz;
    return copy;
  }
  std::vector<RecordingDescription> descriptions;  // what wins stands last
  context.input(path.string());
  for (const auto& file : {signal::description_of_folder(path), signal::description_beside(path)}) {
    if (!file || *file == path) continue;
    context.input(file->string());
    descriptions.push_back(signal::read_description(*file));
  }
  descriptions.push_back(given);
  std::error_code no_size;
  signal::ReadOptions used = context.reading;
  for (auto one = descriptions.rbegin(); one != descriptions.rend(); ++one) {
    used = merged(used, one->reading);
  }
  signal::Recording recording;
  {
    const auto size = static_cast<long>(fs::file_size(path, no_size));
    Progress progress("reading " + path.filename().string(), no_size ? 0 : size,
                      context.quiet || context.silent);
    long told = 0;
    used.done_with = [&](std::size_t bytes) {
      progress.advance(static_cast<long>(bytes) - told);
      told = static_cast<long>(bytes);
    };
    recording = signal::read_recording(path, used);
  }
  for (const auto& description : descriptions) signal::apply_description(description, recording);
  return recording;
}

signal::Recording load_recording(const fs::path& path, VerbContext& context,
                                 const RecordingDescription& given) {
  signal::Recording recording = load_untold(path, context, given);
  tell_notes(recording, context);
  return recording;
}

std::optional<signal::Recording> over_frequency(const std::string& path,
                                                const signal::ReadOptions& reading) {
  const signal::MappedFile file(path);
  signal::Recording functions;
  const auto format = signal::format_of(file.bytes());
  if (format == signal::RecordingFormat::uff) {
    functions = signal::read_uff_functions(file.bytes(), path);
    if (functions.sample_rate_hz > 0 || functions.time_s.size() > 0) return std::nullopt;
  } else if (format == signal::RecordingFormat::csv && !signal::foreign_format(file.bytes())) {
    auto table = signal::frequency_table_in(file.bytes(), path, reading);
    if (!table) return std::nullopt;
    functions.path = path;
    functions.format = "csv";
    functions.channels = std::move(table->functions);
    functions.notes = std::move(table->notes);
    const auto& f = table->frequency_hz;
    functions.notes.push_back({"not_a_time_history",
                               fmt::format("spectra or FRFs, {:.6g} to {:.6g} Hz in {} lines", f[0],
                                           f[f.size() - 1], f.size()),
                               ""});
  }
  if (functions.channels.empty()) return std::nullopt;
  return functions;
}

const signal::Channel& chosen_channel(const signal::Recording& recording, const std::string& name) {
  if (!(recording.sample_rate_hz > 0)) {
    throw UsageError(recording.path.string() + " gives no sample rate: say it with --sample-rate");
  }
  if (!name.empty()) return recording.channel(name);
  if (recording.channels.size() == 1) return recording.channels.front();
  throw UsageError(recording.path.string() + ": name the channel with --channel; there are: " +
                   signal::listed_names(recording.channels));
}

}  // namespace rigfit::apps
