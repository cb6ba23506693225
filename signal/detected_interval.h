// What it does to an interval that only oscillations which stand out of the noise are reported.
//
// Let r^2 be the energy that a mode explains over the noise's variance, and T what r^2 had to
// exceed for the mode to be reported. Of true energy mu^2, r^2 is chi-squared with four degrees
// (amplitude, phase, frequency, decay rate) and non-centrality mu^2. Near T the modes that are
// reported are those that noise enlarged; the likelihood to use is that of the data given that they
// were reported, at the best amplitude for each value theta of interest:
//
//   l(theta) = max_mu [ r(theta) mu - mu^2 / 2 - log P_4(mu) ],   P_k(mu) = P(chi'^2_k(mu^2) > T),
//
// where r(theta)^2 is the energy explained with theta held. Without a threshold (P = 1) that is
// r(theta)^2 / 2, the plain profile likelihood. The best mu solves mu P_6(mu) / P_4(mu) = r.
// Sources: Cox, Hinkley, Theoretical Statistics (1974), ch. 2 and 9 (conditioning); Johnson, Kotz,
// Balakrishnan, Continuous Univariate Distributions 2 (1995), ch. 29 (non-central chi-squared).
#pragma once

namespace rigfit::signal {

/// Factor k' such that the interval of all theta whose sum of squares rises by no more than k'^2
/// noise variances is that of l(theta) within `factor`^2 / 2 of its maximum. `energy`: r^2;
/// `threshold`: T. `factor` itself far above the threshold; at most sqrt(energy), where nothing of
/// the mode would be left.
[[nodiscard]] double factor_of_detected(double energy, double threshold, double factor);

}  // namespace rigfit::signal
