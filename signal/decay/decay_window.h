// Where in a recording the free decay is: after the impact or release, after clipped samples, up to
// the next impact or the end.
//
// The onset is the start s that maximises the energy a causal damped sinusoid takes out of the
// samples from s on, |sum_{j>=s} y_j exp(-(a + i w)(j - s))|^2 / energy of the exponential, which a
// backward recursion gives for all s in O(N); over several w and a. A record that decays from
// its first sample keeps all of it, whatever its noise. Further impacts: decay_hits.h. Where a band
// is asked for, onset and impacts are those of the record within it.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "signal/recording/recording.h"
#include "signal/sinusoids/decay_modes.h"
#include "signal/sinusoids/decay_search.h"

namespace rigfit::signal {

struct DecayWindow {
  Eigen::Index start = 0, end = 0;  ///< samples [start, end)
  bool after_impact = false;        ///< start was moved behind an impact or release
  Eigen::Index clipped_until = 0;   ///< last clipped sample + 1; 0: none found
};

/// All decays of a record, in time. Never empty for a record that has samples. `y`: NaN where
/// missing. `peaks`, when given, gets the peaks of the whole record (decay_search.h) where no band
/// is asked for.
[[nodiscard]] std::vector<DecayWindow> find_decays(const Eigen::Ref<const Eigen::VectorXd>& y,
                                                   const DecayBand& band = {0, 0.5, true},
                                                   std::vector<DecayCandidate>* peaks = nullptr);

/// One past the last sample before a run of equal ones (zeros, as a logger writes that was
/// stopped) that ends the record: 16 samples or more, and three times as long as any other run.
/// The number of samples when there is none.
[[nodiscard]] Eigen::Index recorded_until(const Eigen::Ref<const Eigen::VectorXd>& y);

/// One past the last sample that sits on a rail: an extreme value with flat runs, longer than a
/// sinusoid of that frequency sampled that coarsely shows, or one at which samples pile up
/// (clipping.h). 0: none.
[[nodiscard]] Eigen::Index clipped_until(const Eigen::Ref<const Eigen::VectorXd>& y,
                                         double cycles_per_sample);

}  // namespace rigfit::signal
