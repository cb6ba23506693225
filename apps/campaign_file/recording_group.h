// Recordings of a campaign's test: files or patterns, what they were taken at, how to read them.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/campaign/campaign.h"
#include "model/scene/toml_table.h"
#include "signal/recording/recording.h"

namespace rigfit::apps {

/// The `recording` tables of a test. Throws model::SceneError for what makes no sense.
[[nodiscard]] std::vector<RecordingGroup> read_recording_groups(
    model::TomlTable& test, const std::filesystem::path& folder);

struct LoadedRecording {
  std::string file;
  std::size_t group = 0;
  std::optional<signal::Recording> recording;  ///< empty: see `error`
  std::string error;                           ///< why it cannot be used, with remedy
};

/// Reads every file of the groups, with a call of `file_read` after each; never throws for a bad
/// recording.
[[nodiscard]] std::vector<LoadedRecording> load_recordings(
    const std::vector<RecordingGroup>& groups, const std::function<void()>& file_read = {});

}  // namespace rigfit::apps
