// Responses of versions of a model to the excitation of the rig: FRFs, and the response to a
// release or tap overlaid on a recorded decay.
#pragma once

#include <string>
#include <vector>

#include "ident/campaign/modal/modal_model.h"
#include "ident/campaign/single_tests/decay_campaign.h"
#include "model/frfs/frf_synthesis.h"
#include "model/response/response.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::ident {

/// One version of the model: as given, fitted, ...
struct ModelVersion {
  std::string label;
  model::Scene scene;  ///< instrumented as the test was
};

/// FRFs of a test within its band, and those of the model's versions.
struct FrfComparison {
  signal::FrfSet test;
  /// The test is rebuilt from its modes without the exponential window, which lowers every peak of
  /// the measured FRFs and which no model has.
  bool rebuilt = false;
  Eigen::VectorXd lines_hz;                      ///< the models' lines: a part of the test's
  std::vector<model::SynthesizedFrfs> versions;  ///< sensors x loads of each scene; may be empty
};
[[nodiscard]] FrfComparison compare_frfs(const ModalTestState& recorded,
                                         const std::vector<ModelVersion>& versions,
                                         Eigen::Index most_lines = 1500);

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
