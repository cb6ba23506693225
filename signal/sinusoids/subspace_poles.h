// Two damped sinusoids closer than a line's width: whether they are there, and where to start.
//
// The samples are demodulated at the pole of the one sinusoid that was fitted and averaged over
// blocks, z_k = mean of 2 y exp(-i w j). Two poles p make z_k = sum_m C_m q_m^k, q_m = exp((p_m -
// i w) block): the left singular vectors U of the Hankel matrix of z_k have a shift structure,
// U without its first row = (U without its last row) Q, with q_m the eigenvalues of Q, solved by
// total least squares. Source: Van Huffel, Chen, Decanniere, Van Hecke, J. Magn. Reson. A 110
// (1994) 228 (HTLS); Roy, Kailath, IEEE Trans. ASSP 37 (1989) 984 (ESPRIT).
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace rigfit::signal {

/// White-equivalent variance of a sample near `pole` when what one sinusoid leaves, `residual`, has
/// parts exp(p j) j^2 and exp(p j) j^3 that noise would show with a chance of 1e-5; 0 otherwise.
[[nodiscard]] double pair_evidence(const Eigen::Ref<const Eigen::VectorXd>& residual,
                                   std::complex<double> pole);

/// Poles of the two strongest sinusoids near `pole`, per sample; empty when there are none that
/// last.
[[nodiscard]] std::vector<std::complex<double>> pair_of_poles(
    const Eigen::Ref<const Eigen::VectorXd>& y, std::complex<double> pole);

}  // namespace rigfit::signal
