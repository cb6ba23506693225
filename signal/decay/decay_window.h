// Finds the free decays in a recording: each begins after an impact or release and lasts to
// the next impact or the end.
//
// The onset is the start s that maximises the energy a causal damped sinusoid takes out of the
// samples from s on, |sum_{j>=s} y_j exp(-(a + i w)(j - s))|^2 / energy of the exponential, which a
// backward recursion gives for all s in O(N), for several w and a. A record that decays from its
// first sample on is kept whole, whatever its noise. If a band is given, onset and impacts are
// those of the modes in it.
//
// Further impacts: where a decay ends because the next one starts. The complex amplitude of a mode,
// z(t), changes smoothly along a decay, along a beat and under friction; an impact steps it. With
// means over L cycles z_-2, z_-1 before and z_1, z_2 behind t, both sides are extrapolated to t by
// a straight line,
//   J(t) = (3 z_1 - z_2) / 2 - (3 z_-1 - z_-2) / 2,
// which for z = exp(-a t) is of third order in a L. Where |J| stands out, the damped sinusoids of
// a ten cycles before and behind are fitted apart and together. It is an impact when two fits
// explain more than one (Fisher's test) and the amplitudes of both, taken to t, differ by more than
// a twentieth of the record's largest, a loss that leaves the phase as it is (friction) aside.
// Where a side has more than three modes, whose beats look like blows, the motion must double
// besides. Missing samples are left out of these fits: a gap is no impact.
#pragma once

#include "signal/recording/recording.h"
#include "signal/sinusoids/decay_modes.h"

namespace rigfit::signal {

struct DecayWindow {
  Index start = 0, end = 0;  ///< samples [start, end); a start > 0 is behind an impact
};

/// All decays of a record, in time. Never empty for a record that has samples. `y`: NaN where
/// missing.
[[nodiscard]] std::vector<DecayWindow> find_decays(const Ref<const VectorXd>& y,
                                                   const DecayBand& band = {0, 0.5, true});

/// Number of samples without a run of equal values at the end of the record (a stopped logger
/// writes zeros); such a run has 16 samples or more and does not end a swing that comes to rest on
/// a coarse scale: the 16 samples before it were not all within two steps of it.
[[nodiscard]] Index recorded_until(const Ref<const VectorXd>& y);

}  // namespace rigfit::signal
