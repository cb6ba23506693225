// Statistics of grouped data (hits, points, records, lengths, specimens, blocks): do the groups
// agree, and what are mean and uncertainty?
//
//   x_g = mu + u_g + e_g,   var e_g = v_g known,   var u_g = tau^2
//
// Test: Q = sum (x_g - mean)^2 / v_g follows chi-square with G - 1 degrees where groups agree.
// Mean: weights 1 / (v_g + tau^2) with tau^2 such that Q(tau^2) = G - 1 (Paule and Mandel); the
// variance 1 / sum of weights is then that of Hartung and Knapp. Where tau^2 > 0 it rests on the
// scatter of G groups, and the interval is Student's with degrees
//   (G - 1) sqrt(variance / the part of it due to tau^2),
// which is G - 1 when scatter dominates. For three groups, G - 1 throughout would cover 97.7 % when
// they agree, and the power 2 of Welch and Satterthwaite 89 % when the scatter is as large as v;
// the square root covers between 92 and 97.5 % (groups_test.cc). Jackknife: a quantity x computed
// from all groups has the variance (G - 1) / G sum (x_(-g) - mean)^2, with x_(-g) its value without
// group g, and Student's t with G - 1 degrees. Sources: Cochran, Biometrics 10 (1954) 101; Paule
// and Mandel, J. Res. NBS 87 (1982) 377; Hartung and Knapp, Statist. Med. 20 (2001) 3875; Efron,
// The Jackknife (1982), ch. 3.
#pragma once

#include <cmath>
#include <span>
#include <vector>

namespace rigfit::signal {

/// A mean over groups, which may differ by more than their own uncertainty.
struct GroupMean {
  double mean = 0;
  double variance = 0;          ///< variance of the mean
  double between_variance = 0;  ///< tau^2; 0: groups agree within their own uncertainty
  double cochran_Q = 0;         ///< test of agreement
  double chance = 1;            ///< probability of such a Q where groups agree
  double degrees = 0;  ///< degrees of freedom of `variance`; 0: only the known v_g contribute
  std::vector<double> weights;  ///< sum 1

  /// The standard deviation of which +-1.96 hold 95 %.
  [[nodiscard]] double std_95() const;
  /// tau
  [[nodiscard]] double between_std() const { return std::sqrt(between_variance); }
};

/// Needs at least one value and as many positive `variances`.
[[nodiscard]] GroupMean mean_over_groups(std::span<const double> values,
                                         std::span<const double> variances);

/// Variance of a quantity, of G - 1 degrees of freedom, from its values without each of the groups
/// (at least two).
[[nodiscard]] double jackknife_variance(std::span<const double> without);

/// Factor on a standard deviation of so many degrees of freedom so that +-1.96 of it hold 95 %.
[[nodiscard]] double widening_95(double degrees_of_freedom);

/// Two-sided quantile for a coverage such as 0.95: Student's t, or the normal's for no (<= 0)
/// degrees of freedom.
[[nodiscard]] double coverage_factor(double coverage, double degrees_of_freedom);

}  // namespace rigfit::signal
