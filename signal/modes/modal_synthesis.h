// FRFs rebuilt from exported modes, and how well they agree with the measured ones.
#pragma once

#include "signal/modes/modal_model.h"
#include "signal/modes/modal_result.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// FRFs of `model` in `form` at `frequency_hz` (lines at 0 Hz only when the form has no division by
/// zero there, else they are dropped), as measured under a window of `decay_rate_1_s`.
/// Throws std::invalid_argument when the model's form is unknown and another one is asked.
[[nodiscard]] FrfSet synthesised(const ModalModel& model,
                                 const Eigen::Ref<const Eigen::VectorXd>& frequency_hz,
                                 FrfForm form, double decay_rate_1_s = 0);

/// The same of a whole fit, at the window that it was fitted under: with its background
/// (`ModalResult::background`) at the lines from the first to the last one used, linear between
/// them, 0 at others.
[[nodiscard]] FrfSet synthesised(const ModalResult& fit,
                                 const Eigen::Ref<const Eigen::VectorXd>& frequency_hz,
                                 FrfForm form);

/// Fills `frf_error` of the model and `reconstruction_error` of its modes (within half a bandwidth
/// of 2 zeta f to either side, window included, and at least three lines) from measured FRFs of the
/// lines low_hz <= f <= high_hz. `fitted` are the FRFs of the fit at these lines where it has a
/// smooth background besides (smooth_background.h); empty: those rebuilt from the model.
void measure_errors(ModalModel& model, const FrfSet& measured, double low_hz, double high_hz,
                    const Eigen::Ref<const Eigen::MatrixXcd>& fitted);

}  // namespace rigfit::signal
