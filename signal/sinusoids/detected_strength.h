// How strong an oscillation is that stood out of the noise.
//
// Let R^2 be the energy that a mode explains over the noise's variance, and T what R^2 had to
// exceed for the mode to be reported. Of true energy mu^2, R^2 is chi-squared with four degrees
// (amplitude, phase, frequency, decay rate) and non-centrality mu^2. Near T the modes that are
// reported are those that noise enlarged; what is likely is that of R^2 given that it passed:
//
//   l(mu) = log(I_1(R mu) / mu) - mu^2 / 2 - log P_4(mu),   P_k(mu) = P(chi'^2_k(mu^2) > T),
//   l'(mu) = R I_2(R mu) / I_1(R mu) - mu P_6(mu) / P_4(mu).
//
// Far above T the most likely mu is sqrt(R^2 - 3), and none is (mu = 0) where R^2 < 4 P_6(0) /
// P_4(0), some 2 above T: everything seen may be the noise's. Source: Johnson, Kotz, Balakrishnan,
// Continuous Univariate Distributions 2 (1995), ch. 29.
#pragma once

namespace rigfit::signal {

/// The most likely mu. `energy`: R^2; `threshold`: T.
[[nodiscard]] double detected_strength(double energy, double threshold);

}  // namespace rigfit::signal
