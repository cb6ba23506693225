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
//
// Records that end a time T - t0 after the hit, T their length, lack of each mode what follows,
//   p^n R exp(p (T - t0)) exp(s t0) / (s - p) + conj   (n derivatives of the motion recorded),
// since exp(-s (T - t0)) = exp(s t0) at their lines. exp(s t0) - exp(p t0), over s - p, is the
// integral of exp(s t) exp(p (t0 - t)) over 0 <= t <= t0: no pole, spanned by exp(i w t) with
// these t. What remains is a mode of residue R (1 - exp(p T)) and polynomials in s up to
// s^(n-1), whose sum over modes is no longer zero: for an accelerance a line in s.
#pragma once

#include <Eigen/Core>

namespace rigfit::signal {

/// Orthonormal columns over the lines `s` that span these functions to 1 part in 1000, outside of
/// the residual terms s^power and s^(power - 2). None for `span_s` 0, and where a quarter of the
/// lines' freedom or more would be needed: the noise then differs from line to line nearly as white
/// noise does.
[[nodiscard]] Eigen::MatrixXcd smooth_background(const Eigen::Ref<const Eigen::VectorXcd>& s,
                                                 int power, double span_s);

/// The same with t between -`before_s` and `after_s` (t0 and 0, or the span of noise on the force
/// where that is more) and with s^(power - 1), for records that end before modes have decayed. The
/// latter alone where t spans nothing or too much.
[[nodiscard]] Eigen::MatrixXcd cut_off_background(const Eigen::Ref<const Eigen::VectorXcd>& s,
                                                  int power, double before_s, double after_s);

}  // namespace rigfit::signal
