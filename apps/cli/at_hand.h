// Objects in place of files, for callers that hold them in memory (apps/python). An option that
// names a file then holds a key of these; results that a JSON document does not carry come back
// the same way.
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/cli/verb_context.h"
#include "model/scene/scene.h"
#include "signal/recording/recording.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::apps {

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

/// The recording of that key; null: it is a file.
[[nodiscard]] std::shared_ptr<const signal::Recording> recording_at_hand(
    const std::string& key, const VerbContext& context);

/// The scene of that key, or of the file, which is an input of the run.
[[nodiscard]] model::Scene scene_of(const std::string& key, VerbContext& context);

/// The recording's notes as warnings.
void tell_notes(const signal::Recording& recording, VerbContext& context);

}  // namespace rigfit::apps
