// Sums of powers of a damped rotation, from which every Gram matrix of damped sinusoids is made.
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

}  // namespace rigfit::signal
