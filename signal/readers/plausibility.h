// Values that hardly any laboratory measures, with the likely mistake: most often a sensitivity or
// unit off by a thousand.
#pragma once

#include <optional>
#include <string>

#include "signal/recording/recording.h"

namespace rigfit::signal {

/// A sentence for a person; empty: nothing to say. Limits, of the largest magnitude:
///
///   acceleration  1e5 m/s^2 (10000 g: shock, beyond what vibration is measured with) and 1e-6
///                 m/s^2 (a tenth of a millionth of g, below every sensor's noise)
///   force         1e8 N; with a sensitivity in volts 1e5 N (hammers and dynamic load cells end
///                 before) and 1e-3 N
///   displacement  1000 m;  velocity 1e4 m/s
///
/// `by_voltage`: the channel is scaled by a sensitivity from volts. Zeros and channels without a
/// number are not judged.
[[nodiscard]] std::optional<std::string> implausible_values(const Channel& channel,
                                                            bool by_voltage);

}  // namespace rigfit::signal
