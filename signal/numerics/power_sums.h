// Powers of a damped rotation, and their sums, of which the Gram matrices of damped sinusoids are
// made.
//
//   S_k = sum_{j=0}^{n-1} (j/n)^k q^j
// by doubling, S_k over [0, a + b) = S_k over [0, a) + q^a sum_i binomial(k, i) a^(k-i) S_i over
// [0, b): no cancellation as q -> 1 and no n-fold loop.
#pragma once

#include <array>

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

/// S_k for k = 0, 1, 2. n > 0, |q| <= about 1.
[[nodiscard]] std::array<Complex, 3> power_sums(Complex q, Index n);

/// exp(exponent j) for j = 0 .. count - 1, by doubling: rounding grows with the logarithm of j.
[[nodiscard]] ArrayXcd powers(Complex exponent, Index count);

}  // namespace rigfit::signal
