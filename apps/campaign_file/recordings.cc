#include "apps/campaign_file/recordings.h"

#include <glob.h>

#include <ostream>
#include <system_error>
#include <unordered_set>

#include "apps/cli/progress.h"
#include "model/scene/read_scene.h"
#include "signal/readers/read_recording.h"
#include "signal/recording/recording.h"
#include "signal/recording/recording_time.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
namespace {

/// Files a pattern names, sorted; of a folder none.
std::vector<std::string> matches(const fs::path& pattern) {
  std::vector<std::string> files;
  glob_t found{};
  if (::glob(pattern.c_str(), 0, nullptr, &found) == 0) {
    for (std::size_t i = 0; i < found.gl_pathc; ++i) {
      std::error_code error;
      if (fs::is_regular_file(found.gl_pathv[i], error)) files.emplace_back(found.gl_pathv[i]);
    }
  }
  ::globfree(&found);
  return files;
}

}  // namespace

model::Scene scene_of(const std::string& key, VerbContext& context) {
  if (context.at_hand && context.at_hand->scenes.contains(key)) {
    return *context.at_hand->scenes.at(key);
  }
  context.input(key);
  return model::read_scene(key);
}

void tell_notes(const signal::Recording& recording, VerbContext& context) {
  const std::string file = recording.path.string();
  for (const auto& note : recording.notes) {
    context.warn(note.code, note.message, note.where.empty() ? file : file + ": " + note.where);
  }
}

signal::Recording load_untold(const fs::path& path, VerbContext& context,
                              const RecordingDescription& given) {
  if (context.at_hand && context.at_hand->recordings.contains(path.string())) {
    signal::Recording copy = *context.at_hand->recordings.at(path.string());
    if (!(copy.sample_rate_hz > 0)) copy.sample_rate_hz = context.reading.sample_rate_hz;
    return copy;
  }
  std::vector<RecordingDescription> descriptions;  // what wins stands last
  context.input(path.string());
  for (const auto& file : signal::descriptions_of(path)) {
    context.input(file.string());
    descriptions.push_back(signal::read_description(file));
  }
  descriptions.push_back(given);
  signal::ReadOptions used = context.reading;
  for (auto one = descriptions.rbegin(); one != descriptions.rend(); ++one) {
    used = merged(used, one->reading);
  }
  std::error_code no_size;
  const auto size = static_cast<long>(fs::file_size(path, no_size));
  signal::Recording recording;
  {
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

const signal::Channel& chosen_channel(const signal::Recording& recording, const std::string& name) {
  if (!(recording.sample_rate_hz > 0)) {
    throw UsageError(recording.path.string() + " gives no sample rate: say it with --sample-rate");
  }
  if (!name.empty()) return recording.channel(name);
  if (recording.channels.size() == 1) return recording.channels.front();
  throw UsageError(recording.path.string() + ": name the channel with --channel; there are: " +
                   signal::listed_names(recording.channels));
}

std::vector<RecordingGroup> read_recording_groups(document::TomlTable& test,
                                                  const fs::path& folder) {
  std::vector<RecordingGroup> groups;
  for (document::TomlTable& table : test.tables_or_empty("recording")) {
    RecordingGroup group;
    read_keys(table, keys_of(group));
    std::unordered_set<std::string> taken;
    for (const auto& name : std::exchange(group.files, {})) {
      const auto found = matches(folder / name);
      if (found.empty()) group.missing.push_back((folder / name).string());
      for (const auto& file : found) {
        // The TOML file beside a recording describes it and is none itself.
        if (fs::path(file).extension() == ".toml") continue;
        if (taken.insert(file).second) group.files.push_back(file);
      }
    }
    group.description = signal::read_description(table);
    table.finish();
    groups.push_back(std::move(group));
  }
  return groups;
}

std::vector<LoadedRecording> load_recordings(const std::vector<RecordingGroup>& groups,
                                             const std::function<void()>& file_read) {
  std::vector<LoadedRecording> loaded;
  std::ostream nothing(nullptr);
  for (std::size_t k = 0; k < groups.size(); ++k) {
    for (const auto& name : groups[k].missing) {
      loaded.push_back(
          {name, k, std::nullopt,
           "there is no such file; check the path, it starts at the campaign's folder"});
    }
    for (const auto& file : groups[k].files) {
      LoadedRecording entry{file, k, std::nullopt, ""};
      VerbContext context(nothing);  // its warnings are the recording's notes, which come along
      context.quiet = true;
      context.hashes_inputs = false;
      try {
        entry.recording = load_recording(file, context, groups[k].description);
      } catch (const std::runtime_error& error) {  // RecordingError, SceneError
        entry.error = error.what();
      }
      loaded.push_back(std::move(entry));
      if (file_read) file_read();
    }
  }
  return loaded;
}

}  // namespace rigfit::apps
