// A free decay as figures: the record with its fit and what is left, damping against amplitude.
#pragma once

#include <string>
#include <vector>

#include "apps/report/drawing/plot.h"
#include "signal/decay/decay.h"

namespace rigfit::apps {

/// A decay of a record, as it was analysed.
struct AnalysedDecay {
  std::string file, channel, unit;
  Origin origin = Origin::measured;
  double rate_hz = 0;
  double start_s = 0;       ///< of the samples given
  Eigen::VectorXd samples;  ///< as given to the estimator
  signal::DecayResult result;
};

/// The record, the fitted decay over its window, and the residual.
[[nodiscard]] Plot decay_plot(const std::string& id, const AnalysedDecay& decay);

/// Damping ratio of the strongest mode against amplitude, a series a decay, with 95 % bars. Empty
/// series when no decay has two points.
[[nodiscard]] Plot damping_plot(const std::string& id, const std::vector<AnalysedDecay>& decays);

/// "m/s^2" as people write it.
[[nodiscard]] std::string unit_words(const std::string& unit);

}  // namespace rigfit::apps
