#include "apps/campaign_file/recording_description.h"

#include "signal/readers/read_recording.h"

namespace rigfit::apps {
namespace fs = std::filesystem;

signal::Recording load_recording(const fs::path& path, VerbContext& context,
                                 const signal::ReadOptions& options,
                                 const RecordingDescription& given) {
  RecordingDescription description;
  context.input(path.string());
  if (const auto beside = signal::description_beside(path)) {
    context.input(beside->string());
    description = signal::read_description(*beside);
  }
  signal::ReadOptions used = options;
  if (used.sample_rate_hz == 0) {
    used.sample_rate_hz =
        given.sample_rate_hz > 0 ? given.sample_rate_hz : description.sample_rate_hz;
  }
  signal::Recording recording = signal::read_recording(path, used);
  signal::apply_description(description, recording);
  signal::apply_description(given, recording);
  for (const auto& note : recording.notes) {
    const std::string where =
        note.where.empty() ? path.string() : path.string() + ": " + note.where;
    context.warn(note.code, note.message, where);
  }
  return recording;
}

const signal::Channel& chosen_channel(const signal::Recording& recording, const std::string& name) {
  if (!name.empty()) return recording.channel(name);
  if (recording.channels.size() == 1) return recording.channels.front();
  std::string names;
  for (const auto& c : recording.channels) names += (names.empty() ? "" : ", ") + c.name;
  throw UsageError(recording.path.string() +
                   ": name the channel with --channel; there are: " + names);
}

}  // namespace rigfit::apps
