// Steady sinusoids (hum, machines) in ambient motion, found, fitted and taken out.
//
// A line k of the Hann-windowed transform of the whole recording is tested against the lines 3 to
// 14 beside it, in every channel: F = P_k / mean P. The 24 Hann lines count as 12 independent ones
// of two degrees of freedom each, so that noise exceeds F with the chance (1 + F / 12)^-12. One
// frequency and an amplitude and phase for each channel are fitted to the lines near k. It is a
// tone only when the lines within 2 of it then fall to the level of their neighbours: a narrow mode
// keeps its lines. The amplitude is constant over the recording; a machine whose speed drifts by
// more than a line spacing stays.
#pragma once

#include <vector>

#include "signal/ambient/ambient_result.h"
#include "signal/ambient/ambient_signals.h"

namespace rigfit::signal {

/// Takes tones of low_hz .. high_hz out of `signals`, the strongest 40 at most; gives them by
/// rising frequency.
[[nodiscard]] std::vector<AmbientTone> take_out_tones(AmbientSignals& signals, double low_hz,
                                                      double high_hz);

}  // namespace rigfit::signal
