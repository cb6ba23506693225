// The model laid over a free decay: its answer to the same release or tap in time, the spectra of
// both, and what the same estimator finds in both.
#pragma once

#include <string>
#include <vector>

#include "apps/report/figures/decay_plots.h"
#include "apps/report/modal/model_overlay.h"
#include "signal/decay/decay.h"

namespace rigfit::apps {

/// What one version of the model answers.
struct ReleaseAnswer {
  std::string label;
  model::ResponseResult response;  ///< first sensor only
  Eigen::Index start = 0;          ///< sample of the record where it begins
  signal::DecayResult found;       ///< by the record's estimator, over the same stretch of time
  std::string failure;             ///< why there is no answer; empty: there is one
};

/// Simulates every version, whose scenes have one load and one sensor, for as long as the record
/// lasts, at most 10 s, and moves each along the time axis to where it is most like the record.
[[nodiscard]] std::vector<ReleaseAnswer> release_answers(const AnalysedDecay& decay,
                                                         const signal::DecayOptions& options,
                                                         const std::vector<ModelVersion>& versions,
                                                         int threads);

/// Record and answers: whole, the first half second, and their spectra up to `high_hz` (0: all).
[[nodiscard]] std::vector<Plot> release_plots(const std::string& id, const AnalysedDecay& decay,
                                              const std::vector<ReleaseAnswer>& answers,
                                              double high_hz);

/// The oscillation of an answer that is the one of the record: the nearest in frequency within
/// 15 %; null when there is none.
[[nodiscard]] const signal::DecayMode* same_oscillation(const signal::DecayMode& mode,
                                                        const ReleaseAnswer& answer);

}  // namespace rigfit::apps
