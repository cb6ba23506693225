// Treats a sample rate with relative standard uncertainty e as an input of a fit
// (signal::Recording::sample_rate_relative_std: a step printed with few digits).
//
// An analyser has one clock: recordings at the same stated rate, of one state or of several, have
// the same relative error in all frequencies. As one input that moves them together, its part of
// the uncertainty does not shrink with the number of recordings, as noise of each frequency would.
// The frequencies' own standard uncertainties must then exclude it.
#pragma once

#include <string_view>
#include <vector>

#include "ident/update/problem/update_data.h"

namespace rigfit::ident {

/// Target of an UncertainInput's effect that stands for all measured frequencies of the state
/// (modes and FRF lines) instead of a scene parameter; the change is relative.
inline constexpr std::string_view kSampleRateTarget = "sample rate";

/// Stated sample rate of a state's recordings, with its relative uncertainty e.
struct StateClock {
  int state = 0;
  double rate_hz = 0, relative_std = 0;
};

/// One input for each stated rate (within 1e-6), called "sample rate", with its Hz where there are
/// several. For a state listed several times with the same rate the largest e counts; a state with
/// several rates is affected by each. Clocks with e = 0 are left out.
[[nodiscard]] std::vector<UncertainInput> sample_rate_inputs(const std::vector<StateClock>& clocks);

}  // namespace rigfit::ident
