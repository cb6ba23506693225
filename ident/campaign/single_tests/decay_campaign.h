// Evaluates the free decays of one recording: finds every decay of a channel and fits the
// strongest, or fits each and pools their modes.
//
// Pooled over decays, a mode's frequency (and likewise its damping ratio) is x_i = mu + u_i + e_i
// with var e_i from the fit and var u_i = tau^2 between decays
// (signal/estimation/groups.h). The result is the mean mu with its uncertainty, and the scatter
// tau, which does not shrink with more decays.
//
// Where the file states its rate rounded (Recording::sample_rate_relative_std), that relative error
// is common to all frequencies: it is added in quadrature to their standard uncertainties and
// intervals, after pooling, and reported ("rate_uncertainty"). Damping ratios do not depend on the
// rate.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ident/campaign/single_tests/finding.h"
#include "signal/decay/decay.h"
#include "signal/recording/recording.h"

namespace rigfit::ident {

struct DecayTestOptions {
  std::vector<std::string> channels;     ///< empty: all
  std::optional<double> start_s, end_s;  ///< on the file's time axis; a given start is not moved
  bool each = false;                     ///< fit every decay, not the strongest only
  signal::DecayOptions decay;            ///< its band; window and start time are set here
};

/// One decay of a channel. Times are those of the file.
struct FoundDecay {
  double start_s = 0, end_s = 0;              ///< window as fitted, or as found if not fitted
  bool fitted = false;                        ///< a fit was made
  std::optional<signal::DecayResult> result;  ///< with `each`; its window counts from `first`
  Eigen::Index first = 0;                     ///< sample of the recording
};

struct PooledMode {
  signal::Estimate frequency_hz, damping_ratio;  ///< mean, its standard uncertainty
  signal::Interval frequency_interval_95_hz, damping_ratio_interval_95;
  double frequency_scatter_hz = 0, damping_ratio_scatter = 0;  ///< tau; 0: the decays agree
  std::size_t decays = 0;                                      ///< number that show the mode
};

struct ChannelDecays {
  std::string channel, unit;
  double sample_rate_hz = 0;
  double start_time_s = 0;         ///< time of samples[0], s
  Eigen::VectorXd samples;         ///< between start and end
  double start_s = 0, end_s = 0;   ///< window of `strongest`
  signal::DecayResult strongest;   ///< see signal/decay/decay.h
  std::vector<FoundDecay> decays;  ///< in time, one at least
  std::vector<PooledMode> pooled;  ///< with `each`, in the order of the strongest decay's modes
  std::vector<Finding> findings;   ///< refused: the strongest decay has no result
};

/// One entry per channel; a recording with uneven times has none, and a finding instead.
struct DecayTest {
  std::vector<ChannelDecays> channels;
  std::vector<Finding> findings;
};

/// Finding "not_uniform" for a recording that cannot be used for decays; empty: it can.
[[nodiscard]] std::optional<Finding> not_uniform(const signal::Recording& recording);

/// Throws RecordingError for a missing channel, std::invalid_argument when there are no samples
/// between start and end.
[[nodiscard]] DecayTest run_decay_test(const signal::Recording& recording,
                                       const DecayTestOptions& options);

}  // namespace rigfit::ident
