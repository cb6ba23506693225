// Poles that a non-linear structure shows beside its modes.
//
// To first order a quadratic stiffness is driven by products of two modes' motions: ring-downs with
// poles p_a + p_b and p_a + conj(p_b), decay rates added. A cubic one is driven by products of
// three, among them p_a + p_b + conj(p_b): the frequency of mode a, damped more than it. In FRFs
// they look like modes, weak ones beside the modes that make them (Nayfeh and Mook, Nonlinear
// Oscillations, ch. 6). A pole that agrees in frequency and decay rate with such a sum, and is
// weaker than its modes, may be either.
#pragma once

#include <string>

#include "signal/modes/modal_model.h"

namespace rigfit::signal {

/// Why mode `r` may be none but a combination of stronger ones, for a person; empty when nothing
/// says so. `power`: of s in the FRFs, by which peaks are compared.
[[nodiscard]] std::string combination_doubt(const ModalModel& model, std::size_t r, int power);

}  // namespace rigfit::signal
