// What noise on the force near the hits adds to FRFs.
//
// A force window keeps the noise n(t) within a time T of the hit. The transform of the measured
// force is F (1 + e), e = N / F smooth over lines, since n lies within T. With H = sum_r R_r /
// (s - p_r) + ... the measured FRFs are
//   H (1 - e + e^2 ..) = sum_r R_r' / (s - p_r) + B(s):
// poles stay in place, residues change by some parts of 1, and B has no pole: its inverse transform
// lies within T of the hit as well (an impulse response convolved with a signal of that length is a
// sum of the same damped sinusoids outside of it). B is spanned by exp(-i w t), |t| <= T, of which
// a band of width b needs about 2 T b + some (Slepian, Bell Syst. Tech. J. 57 (1978) 1371).
#pragma once

#include <Eigen/Core>

namespace rigfit::signal {

/// Orthonormal columns over the lines `s` that span these functions to 1 part in 1000, outside of
/// the residual terms s^power and s^(power - 2). Empty for `span_s` 0, and where a quarter of the
/// lines' freedom or more would be needed: the noise then differs from line to line nearly as white
/// noise does.
[[nodiscard]] Eigen::MatrixXcd smooth_background(const Eigen::Ref<const Eigen::VectorXcd>& s,
                                                 int power, double span_s);

}  // namespace rigfit::signal
