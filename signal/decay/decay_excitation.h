// Whether a mode is excited while it is said to decay: ambient motion, a machine, wind.
//
// What a fit leaves at a mode's frequency, as complex amplitudes z_k over blocks (means of
// 2 r exp(-i w j)), is of noise alone white with E|z|^2 = 4 s^2 / block. A mode that changes as it
// decays (friction, a neighbouring mode that beats slowly) leaves something smooth: a polynomial of
// the sixth degree in time is taken out. Excitation leaves a random walk, which is neither, over
// the whole of the record and not only where the motion is large.
#pragma once

#include <Eigen/Core>

namespace rigfit::signal {

struct Excitation {
  double amplitude = 0;      ///< rms of z, the noise's share taken off; 0: none seen
  double over_noise = 1;     ///< mean |z|^2 over what noise of that density would leave
  double later_share = 0.5;  ///< part of the sum of |z|^2 in the second half
  Eigen::Index blocks = 0;
  bool significant = false;  ///< chance of 1e-6 in noise
};

/// Samples of a block, of `samples` in all.
[[nodiscard]] Eigen::Index excitation_block(Eigen::Index samples, double w);

/// `residual`: of the fit; `w`: of the mode, rad per sample; `noise_variance`: white-equivalent
/// variance of a sample near the mode.
[[nodiscard]] Excitation excitation_at(const Eigen::Ref<const Eigen::VectorXd>& residual, double w,
                                       double noise_variance);

}  // namespace rigfit::signal
