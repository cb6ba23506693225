// What a run starts from: recordings read with their descriptions
// (signal/readers/recording_description.h), one by one or as the groups of a campaign's test, and
// scenes; files, which become inputs of the run, or objects in their place.
#pragma once

#include <Eigen/Core>

#include "apps/campaign/campaign.h"
#include "apps/cli/verb_context.h"
#include "document/toml_table.h"
#include "model/scene/scene.h"
#include "signal/readers/recording_description.h"
#include "signal/recording/recording.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::apps {

using signal::RecordingDescription;

/// Objects in place of files, of callers that hold them in memory (apps/python). An option that
/// names a file then holds a key of these; results that a JSON document does not carry come back
/// the same way.
struct AtHand {
  std::map<std::string, std::shared_ptr<const signal::Recording>> recordings;
  std::map<std::string, std::shared_ptr<const model::Scene>> scenes;
  std::shared_ptr<signal::FrfSet> frfs;  ///< to be identified; then those averaged or used

  // Results.
  std::shared_ptr<signal::Recording> resampled;
  Eigen::MatrixXd samples;     ///< a response: rows x sensors
  Eigen::MatrixXd covariance;  ///< between a fit's parameters
  std::vector<model::Scene> fitted_scenes;
};

/// The scene of that key, or of the file, which is an input of the run.
[[nodiscard]] model::Scene scene_of(const std::string& key, VerbContext& context);

/// Reads a recording with the TOML file beside it, if there is one; both become inputs of this run
/// and every note of the reader becomes a warning. `given` adds to (and wins over) the file beside
/// it: what a campaign entry or the command line says.
[[nodiscard]] signal::Recording load_recording(const std::filesystem::path& path,
                                               VerbContext& context,
                                               const RecordingDescription& given = {});

/// The same; its notes are not told yet.
[[nodiscard]] signal::Recording load_untold(const std::filesystem::path& path, VerbContext& context,
                                            const RecordingDescription& given = {});
/// The recording's notes as warnings.
void tell_notes(const signal::Recording& recording, VerbContext& context);

/// The channel `name`; without a name that of a recording with one channel only. Throws UsageError
/// when the choice is open or the sample rate is not known.
[[nodiscard]] const signal::Channel& chosen_channel(const signal::Recording& recording,
                                                    const std::string& name);

/// The `recording` tables of a campaign's test: files or patterns, what they were taken at, how to
/// read them. Throws model::SceneError for what makes no sense.
[[nodiscard]] std::vector<RecordingGroup> read_recording_groups(
    document::TomlTable& test, const std::filesystem::path& folder);

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
