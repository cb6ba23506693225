// What readers do alike with the sampling of a recording.
#pragma once

#include "signal/recording/recording.h"
#include "signal/recording/time_axis.h"

namespace rigfit::signal {

/// Takes the sample rate that somebody states, as exact, in place of what the file gives; 0: none
/// is stated. Notes "rate_overridden" where the file's differs by more than 1e-4, relative: then
/// its times no longer hold either and go.
void take_stated_rate(double rate_hz, Recording& recording);

/// "time_not_uniform", with the counts of what is wrong with the times.
[[nodiscard]] Note not_uniform_note(const TimeAxis& axis);

}  // namespace rigfit::signal
