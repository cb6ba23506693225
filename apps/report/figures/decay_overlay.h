// The model laid over a free decay: its answer to the same release or tap in time, the spectra of
// both, and what the same estimator finds in both.
#pragma once

#include <string>
#include <vector>

#include "apps/report/figures/decay_plots.h"
#include "ident/campaign/modal/model_answers.h"

namespace rigfit::apps {

using ident::ReleaseAnswer;

/// Record and answers over the first half second, and their spectra up to `high_hz` (0: all).
[[nodiscard]] std::vector<Plot> release_plots(const std::string& id, const AnalysedDecay& decay,
                                              const std::vector<ReleaseAnswer>& answers,
                                              double high_hz);

/// Amplitudes over frequency up to `high_hz` (0: all) under a Hann window, added to `series`.
[[nodiscard]] PlotSeries amplitude_spectrum(const Eigen::Ref<const Eigen::VectorXd>& samples,
                                            double rate_hz, double high_hz, PlotSeries series);

}  // namespace rigfit::apps
