// A sample rate that is known to a relative standard uncertainty e (signal::Recording::
// sample_rate_relative_std: its step is printed with few digits), as an input of a fit.
//
// An analyser has one clock: recordings at the same stated rate, of one state or of several, have
// frequencies that are all off by the same part. As one input that moves them together its part of
// the uncertainty does not shrink with the number of recordings; as noise of each frequency it
// would. The frequencies' own standard uncertainties must be without it then.
#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "ident/update/problem/update_data.h"

namespace rigfit::ident {

/// As target of an UncertainInput's effect: no scene parameter but all measured frequencies of the
/// state (of modes, of the lines of FRFs); the change is relative.
inline constexpr std::string_view kSampleRateTarget = "sample rate";

/// What was measured in a state was sampled at that stated rate, known to e.
struct StateClock {
  int state = 0;
  double rate_hz = 0, relative_std = 0;
};

/// One input for each stated rate (within 1e-6), called "sample rate", with its Hz where there are
/// several. Of a state that is listed several times with one rate the largest e counts; those of
/// several rates are off by each. Clocks with e = 0 are left out.
[[nodiscard]] std::vector<UncertainInput> sample_rate_inputs(const std::vector<StateClock>& clocks);

/// What the state's measured frequencies are to be multiplied by where each input is off by so many
/// standard uncertainties; `off` may be empty.
[[nodiscard]] double sample_rate_factor(const std::vector<UncertainInput>& inputs,
                                        const Eigen::VectorXd& off, int state);

/// Relative standard uncertainty of the state's frequencies by these inputs.
[[nodiscard]] double sample_rate_std(const std::vector<UncertainInput>& inputs, int state);

}  // namespace rigfit::ident
