// Modes of a structure that is not linear, at small amplitude: from hits of different size.
//
// A test of the FRFs themselves says whether they go with the size of the hits: at every line
//   H_h = H_mean + D (J_h^2 - mean) + rest,   h: hits of impulse J_h on one point,
// F = (power of the D part) / (power of the rest a degree of freedom), one and n - 2 degrees of
// freedom a point, as few as if all lines changed together. A cubic spring gives FRFs that do, to
// first order. Then, for each mode that is not doubtful,
// - frequency and damping ratio are those at small amplitude, by the line over its single hits
//   (amplitude_trend.h), whether or not its own slope is beyond chance. With e the change of the
//   FRFs around it to small amplitude, of them, the next order of the series shifts the pole by
//   some e^2 of the half bandwidth, which the standard deviations contain;
// - it is doubtful where e is above one half (too much for a first order; also a combination of
//   other modes' frequencies, whose share in the FRFs goes with the squared impulse, e = 1), where
//   single hits show it elsewhere or not at all, or where a stronger mode overlaps with it.
// Source of the orders: Worden and Tomlinson, Nonlinearity in Structural Dynamics, ch. 2 and 3.
#pragma once

#include <vector>

#include "signal/modes/modal_band.h"
#include "signal/modes/modal_model.h"
#include "signal/spectra/frf_set.h"
#include "signal/variation/hit_scatter.h"

namespace rigfit::signal {

/// Chance of FRFs of single hits that go with the squared impulse as much as these, where size does
/// nothing; 1 where fewer than three hits of known and different size struck any point. Lines from
/// `low_hz` to `high_hz`.
[[nodiscard]] double chance_of_size_dependence(const FrfSet& frfs, double low_hz, double high_hz);

/// As above where the chance is below 1 %, with the note "frequency_depends_on_amplitude" for each
/// mode; below 20 % standard deviations reach to the values at small amplitude. Where hits of a
/// point tell nothing the frequencies of points struck in turn do, by the same limits of the mode's
/// own chance; where their hits' sizes are not known and frequencies go with the shape, the mode is
/// doubtful. `hits`: of modes_of_hits(), empty where there are none.
void allow_for_amplitude(const FrfSet& frfs, const ModalBand& band,
                         const std::vector<ModeOfHits>& hits, ModalModel& model);

}  // namespace rigfit::signal
