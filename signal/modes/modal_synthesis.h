// Synthesises FRFs from exported modes.
#pragma once

#include "signal/modes/modal_result.h"

namespace rigfit::signal {

/// FRFs of `model` in `form` at `frequency_hz` (lines at 0 Hz are dropped where the form divides by
/// zero), as measured under a window of `decay_rate_1_s`.
/// Throws std::invalid_argument when the model's form is unknown and `form` is another one.
[[nodiscard]] FrfSet synthesised(const ModalModel& model, const Ref<const VectorXd>& frequency_hz,
                                 FrfForm form, double decay_rate_1_s = 0);

/// FRFs of a whole fit, under the window of that fit. Its background (`ModalResult::background`) is
/// added from the first to the last line used, linearly interpolated, and is 0 at other lines.
[[nodiscard]] FrfSet synthesised(const ModalResult& fit, const Ref<const VectorXd>& frequency_hz,
                                 FrfForm form);

}  // namespace rigfit::signal
