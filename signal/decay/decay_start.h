// Where a free decay starts: behind the tail of what set it off.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "signal/sinusoids/damped_sinusoids.h"
#include "signal/sinusoids/decay_modes.h"

namespace rigfit::signal {

struct DecayStart {
  Eigen::Index start = 0;  ///< sample of `y`
  DecaySamples samples;    ///< from there on
  DampedSinusoidsFit fit;  ///< the modes found in them
};

/// Moves the start on by half a cycle of the strongest mode at a time, while the first half cycle
/// leaves three times the rms of what comes later, by three cycles or 0.35 time constants at most.
/// `fit`: the modes found in y(start .. end). Nothing when they may stay.
///
/// What decides is a search for modes from each start. That costs many fits: fits of the modes
/// already known go ahead, and the search looks from where they stop, back while an earlier start
/// will do and on while a later one is needed.
[[nodiscard]] std::optional<DecayStart> later_start(const Eigen::Ref<const Eigen::VectorXd>& y,
                                                    Eigen::Index start, Eigen::Index end,
                                                    const DampedSinusoidsFit& fit,
                                                    const DecayBand& band,
                                                    const DecayModesOptions& options);

}  // namespace rigfit::signal
