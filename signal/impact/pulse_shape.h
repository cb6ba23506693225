// Whether a channel looks like a hammer's force around a hit, or like a response.
//
// A hammer pushes to one side, shortly, and its force is zero before and after. A response swings
// to both sides and rings on. Two figures tell them apart: the largest swing to the other side over
// the peak, and the part of the energy that comes more than five pulse widths away from the pulse,
// both beyond what the channel's noise gives.
//
// Second contacts of a hammer with the structure, before or after the hit:
// y(k) = sum_i p_i x(k + i) / sum_i p_i^2 with p the hit's own pulse scaled to one: a second
// contact of the same shape and a times the height peaks at y = a times the hit's peak, white noise
// falls by sqrt(sum p^2).
#pragma once

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

/// A pulse ends below this part of its peak.
inline constexpr double kPulseEdge = 0.1;

/// As it is made: neither.
struct PulseShape {
  double opposite = 0.4;  ///< largest swing to the other side, of the peak, 0..1
  double outside = 0.25;  ///< energy outside of pulse and surroundings, of all, 0..1
  /// Hammers that ring in their own handle, filters and AC-coupled amplifiers stay below 0.3 in
  /// both, a mode of 10 % damping swings back by 0.73; modes damped by more leave nothing outside
  /// and are not told.
  [[nodiscard]] bool rings() const { return opposite > 0.5 && outside > 0.3; }
  [[nodiscard]] bool is_pulse() const { return opposite < 0.3 && outside < 0.2; }
};

/// Shape of the samples first .. first + length - 1 with their largest absolute value as the peak.
/// Rest and noise are taken where the block is quietest: before the hit or at its end. Missing
/// samples count as rest. No signal: neither rings nor is a pulse.
[[nodiscard]] PulseShape pulse_shape(const VectorXd& samples, Index first, Index length);

struct SecondContact {
  double ratio = 0;             ///< second contact relative to the peak; 0: none found
  Index delay = 0;              ///< samples from peak to peak; negative: before the hit
  double smallest_visible = 0;  ///< larger of `smallest` and what noise hides, relative to the peak
};

/// `force`: one block, offset removed, pulses upwards, finite; the hit's pulse spans
/// pulse_first..pulse_last with its peak at `peak`. `smallest`: second contact looked for, relative
/// to the peak.
[[nodiscard]] SecondContact find_second_contact(const Ref<const VectorXd>& force, Index pulse_first,
                                                Index peak, Index pulse_last, double smallest);

}  // namespace rigfit::signal
