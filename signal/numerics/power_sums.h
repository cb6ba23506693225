// Powers of a damped rotation, and their sums, of which the Gram matrices of
// damped sinusoids are made.
//
//   S_k = sum_{j=0}^{n-1} (j/n)^k q^j
// by doubling, S_k over [0, a + b) = S_k over [0, a) + q^a sum_i binomial(k, i) a^(k-i) S_i over
// [0, b): no cancellation as q -> 1 and no n-fold loop.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <span>

namespace rigfit::signal {

/// S_k for k = 0 .. sums.size()-1 (at most 5). n > 0, |q| <= about 1.
void power_sums(std::complex<double> q, Eigen::Index n, std::span<std::complex<double>> sums);

/// exp(exponent j) for j = 0 .. count - 1, by doubling: rounding grows with the logarithm of j.
[[nodiscard]] Eigen::ArrayXcd powers(std::complex<double> exponent, Eigen::Index count);

}  // namespace rigfit::signal
