// FRFs rebuilt from exported modes.
#pragma once

#include <Eigen/Core>

#include "signal/modes/modal_model.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// Power of s that makes `form` from receptance; unknown counts as receptance.
[[nodiscard]] int power_of_s(FrfForm form);

/// s = decay_rate + i 2 pi f.
[[nodiscard]] Eigen::VectorXcd laplace_lines(const Eigen::Ref<const Eigen::VectorXd>& frequency_hz,
                                             double decay_rate_1_s);

/// FRFs of `model` in `form` at `frequency_hz` (lines at 0 Hz only when the form has no division by
/// zero there, else they are dropped), as measured under a window of `decay_rate_1_s`.
/// Throws std::invalid_argument when the model's form is unknown and another one is asked.
[[nodiscard]] FrfSet synthesised(const ModalModel& model,
                                 const Eigen::Ref<const Eigen::VectorXd>& frequency_hz,
                                 FrfForm form, double decay_rate_1_s = 0);

}  // namespace rigfit::signal
