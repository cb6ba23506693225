// Frequency and damping of a free decay, with uncertainty.
//
//   y(t) = sum_m A_m exp(-zeta_m w_m t) cos(w_m sqrt(1 - zeta_m^2) t + phi_m) + background + noise
//
// by least squares within the band asked for (damped_sinusoids.h); the background is an offset, a
// drift and, where the data ask for it, an offset that decays. f = w / 2 pi is the undamped natural
// frequency, as for modes from FRFs; the damped one is given beside it. Starts come from a
// matched-filter bank; modes and tones are added strongest first as long as the residual holds a
// peak that noise around it would not show (decay_modes.h). Samples on a rail that the fit to the
// others goes beyond are missing samples. Uneven times are used as they are.
#pragma once

#include <Eigen/Core>

#include "signal/decay/decay_result.h"

namespace rigfit::signal {

/// `y`: NaN where missing; at even times unless the options give them. Throws std::invalid_argument
/// for a rate or a band that makes no sense; all that the data can do wrong is a refusal or a note.
[[nodiscard]] DecayResult estimate_decay(const Eigen::Ref<const Eigen::VectorXd>& y,
                                         double sample_rate_hz, const DecayOptions& options = {});

}  // namespace rigfit::signal
