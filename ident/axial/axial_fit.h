// EA of a cable, and a compliance in series, from the frequencies at several lengths.
//
// At each length i the undamped frequency solves
//   W M = K(W),   1/K = 1/km + q s + R,   R = (T + r) / (kc (1 - x^2 T r)),
//   kc = EA_i / L_i,   x^2 = W m L_i / kc,   T = tan(x) / x,   r = kc (1 - q) s,   W = omega^2
// (rod_stiffness.h; the rod's upper end rests on the part (1 - q) s of the compliance, which is the
// frame's, the part q s lies below, where the adapter is; a frame that is told adds kc / kf to r).
// Least squares by Ceres over
//   ln EA, s and, as normal priors, M, m, km, kf, q, every L_i and, with scatter between lengths,
//   ln EA_i = ln EA + u_i, var u_i = tau^2,
// so that what all lengths share (mass, adapter) is shared. Where the unknown compliance lies is
// not known: q is 1/2 with the standard deviation of a uniform distribution, 0.29; for s EA / L =
// 0.1 it makes 0.4 % of EA. The records of one length enter as the mean of ln W, which is all that
// records of equal variance say about it.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace rigfit::ident {

struct AxialSetup;

/// What the records of one length say.
struct AxialLengthData {
  double length_m = 0;
  double log_omega_squared = 0;      ///< mean of ln W, W in 1/s^2
  double log_omega_squared_std = 0;  ///< of the mean
};

/// A share of the uncertainty of EA.
struct AxialContribution {
  std::string source;
  double variance = 0;  ///< of ln EA
};

struct AxialFit {
  bool series = false;     ///< a compliance in series is fitted
  double between_std = 0;  ///< tau, relative
  bool converged = false;  ///< false: nothing below holds
  double EA_N = 0;         ///< per unit strain, of the cable alone
  double EA_relative_std = 0;
  double compliance_m_N = 0, compliance_std_m_N = 0;  ///< s
  double chi2 = 0;
  int degrees = 0;              ///< lengths less free parameters
  double log_likelihood = 0;    ///< of the frequencies, up to a constant that all fits share
  double between_variance = 0;  ///< share of the variance of ln EA that tau makes
  std::vector<AxialContribution> contributions;
};

/// One fit with tau given (relative to EA; 0: none). `start_EA_N` positive.
[[nodiscard]] AxialFit fit_axial(std::span<const AxialLengthData> lengths, const AxialSetup& setup,
                                 bool series, double between_std, double start_EA_N);

/// The same with tau by Paule and Mandel: the least for which chi-squared is its expectation.
/// `without`: the fit with tau 0.
[[nodiscard]] AxialFit fit_axial_with_scatter(std::span<const AxialLengthData> lengths,
                                              const AxialSetup& setup, const AxialFit& without);

}  // namespace rigfit::ident
