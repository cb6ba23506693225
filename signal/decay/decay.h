// Frequency and damping of a free decay, with uncertainty.
//
//   y(t) = sum_m A_m exp(-zeta_m w_m t) cos(w_m sqrt(1 - zeta_m^2) t + phi_m) + c0 + c1 t + noise
//
// by least squares (damped_sinusoids.h). f = w / 2 pi is the undamped natural frequency, as for
// modes from FRFs; the damped one is given beside it. Starts come from a matched-filter bank; modes
// are added strongest first as long as the residual holds a peak that noise of its own colour
// would not show. Uncertainties follow from the residual, its colour and where in the record it is
// large (residual_noise.h). Where the band asked for lies far below the sample rate, the fit is
// made there (decay_steps.h).
#pragma once

#include "signal/decay/decay_result.h"

namespace rigfit::signal {

/// `y`: samples, NaN where missing, uniform but for `options.late`. Throws std::invalid_argument
/// for a rate or a band that makes no sense; unsuitable data lead to a refusal or a note.
[[nodiscard]] DecayResult estimate_decay(const Ref<const VectorXd>& y, double sample_rate_hz,
                                         const DecayOptions& options = {});

}  // namespace rigfit::signal
