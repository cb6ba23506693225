#include "apps/campaign_file/recording_group.h"

#include <glob.h>

#include <ostream>
#include <unordered_set>
#include <utility>

#include "apps/campaign_file/recording_description.h"
#include "signal/recording/recording_error.h"

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

std::vector<RecordingGroup> read_recording_groups(model::TomlTable& test, const fs::path& folder) {
  std::vector<RecordingGroup> groups;
  for (model::TomlTable& table : test.tables_or_empty("recording")) {
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
      } catch (const signal::RecordingError& error) {
        entry.error = error.what();
      } catch (const model::SceneError& error) {
        entry.error = error.what();
      }
      loaded.push_back(std::move(entry));
      if (file_read) file_read();
    }
  }
  return loaded;
}

}  // namespace rigfit::apps
