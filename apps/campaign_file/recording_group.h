// Recordings of a campaign's test: files or patterns, what they were taken at, how to read them.
//
//   [[test.recording]]
//   files = ["recordings/bending_*.csv"]   # files, or patterns with * and ?
//   tension = 200.0                        # N, where the test goes by tension
//   length = 1.0                           # m, where it goes by length
//   load = "hammer"                        # of the scene, where one test strikes several places
//   synthetic = false                      # true: made by a virtual laboratory
//   sample_rate_hz, [[test.recording.channel]]: as in a TOML file beside a recording
//
// A file that is not there or cannot be read is no error of the campaign: the report says so in its
// place and goes on.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/campaign_file/recording_description.h"
#include "apps/report/drawing/plot.h"
#include "model/scene/toml_table.h"
#include "signal/recording/recording.h"

namespace rigfit::apps {

struct RecordingGroup {
  std::vector<std::string> files;    ///< sorted, each once
  std::vector<std::string> missing;  ///< names and patterns that match no file
  std::optional<double> tension_N, length_m;
  std::string load;  ///< name of the scene's load; empty: the test's
  bool synthetic = false;
  RecordingDescription description;

  [[nodiscard]] Origin origin() const { return synthetic ? Origin::synthetic : Origin::measured; }
};

/// The `recording` tables of a test. Throws model::SceneError for what makes no sense.
[[nodiscard]] std::vector<RecordingGroup> read_recording_groups(
    model::TomlTable& test, const std::filesystem::path& folder);

struct LoadedRecording {
  std::string file;
  std::size_t group = 0;
  std::optional<signal::Recording> recording;  ///< empty: see `error`
  std::string error;                           ///< why it cannot be used, with remedy
  std::vector<std::string> inputs;             ///< files read for it
};

/// Reads every file of the groups, with a call of `file_read` after each; never throws for a bad
/// recording.
[[nodiscard]] std::vector<LoadedRecording> load_recordings(
    const std::vector<RecordingGroup>& groups, const std::function<void()>& file_read = {});

}  // namespace rigfit::apps
