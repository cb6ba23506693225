// What versions of a model answer to what was done to the rig: FRFs, the response to a hit as it
// was recorded, and the response to a release or tap, laid over a recorded decay.
#pragma once

#include <string>
#include <vector>

#include "ident/campaign/modal/modal_model.h"
#include "model/frfs/frf_synthesis.h"
#include "model/response/response.h"
#include "signal/decay/decay.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::ident {

/// One version of the model: as given, fitted, ...
struct ModelVersion {
  std::string label;
  model::Scene scene;  ///< instrumented as the test was
};

/// The FRFs of a test within its band and those of the versions.
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

/// What each version answers to the force of a hit on its first load, as recorded; not completed
/// where it gives no answer. The force is that of the pulse: what is recorded beside it is noise.
[[nodiscard]] std::vector<model::ResponseResult> answers_to_hit(
    const RecordedHit& hit, const std::vector<ModelVersion>& versions);

/// What one version answers to a release or tap.
struct ReleaseAnswer {
  std::string label;
  model::ResponseResult response;  ///< first sensor only
  Eigen::Index start = 0;          ///< sample of the record where it begins
  signal::DecayResult found;       ///< by the record's estimator, over the same stretch of time
  std::string failure;             ///< why there is no answer; empty: there is one
};

/// A recorded decay: its samples and the window that its estimator used.
struct RecordedDecay {
  Eigen::VectorXd samples;  ///< NaN where missing
  double rate_hz = 0;
  Eigen::Index start = 0, end = 0;
};

/// Simulates every version, whose scenes have one load and one sensor, for as long as the record
/// lasts, at most 10 s, and moves each along the time axis to where it is most like the record.
[[nodiscard]] std::vector<ReleaseAnswer> release_answers(const RecordedDecay& decay,
                                                         const signal::DecayOptions& options,
                                                         const std::vector<ModelVersion>& versions,
                                                         int threads);

/// The oscillation of an answer that is the one of the record: the nearest in frequency within
/// 15 %; null when there is none.
[[nodiscard]] const signal::DecayMode* same_oscillation(const signal::DecayMode& mode,
                                                        const ReleaseAnswer& answer);

/// Missing samples at the mean of the others.
[[nodiscard]] Eigen::VectorXd filled(const Eigen::VectorXd& samples);

}  // namespace rigfit::ident
