// Responses of versions of a model to the release or tap of a recorded decay.
#pragma once

#include <string>
#include <vector>

#include "ident/campaign/modal/modal_model.h"
#include "ident/campaign/single_tests/decay_campaign.h"
#include "model/response/response.h"

namespace rigfit::ident {

/// One version of the model: as given, fitted, ...
struct ModelVersion {
  std::string label;
  model::Scene scene;  ///< instrumented as the test was
};

/// Response of one version to a release or tap.
struct ReleaseAnswer {
  std::string label;
  model::ResponseResult response;  ///< first sensor only
  Eigen::Index start = 0;          ///< sample of the record where it begins
  signal::DecayResult found;  ///< decay of the response, from the record's estimator and window
  std::string failure;        ///< why there is no answer; empty: there is one
};

/// Simulates every version, whose scenes have one load and one sensor, for as long as the record
/// lasts, at most 10 s, and shifts each in time to best match the record.
[[nodiscard]] std::vector<ReleaseAnswer> release_answers(const ChannelDecays& decays,
                                                         const signal::DecayOptions& options,
                                                         const std::vector<ModelVersion>& versions,
                                                         int threads);

/// The oscillation of an answer that corresponds to `mode`: the nearest in frequency within 15 %;
/// null when there is none.
[[nodiscard]] const signal::DecayMode* same_oscillation(const signal::DecayMode& mode,
                                                        const ReleaseAnswer& answer);

/// `samples` with the mean in place of missing ones.
[[nodiscard]] Eigen::VectorXd filled(const Eigen::VectorXd& samples);

}  // namespace rigfit::ident
