// One value from several groups that may differ by more than their own uncertainty.
//
//   x_i = mu + u_i + e_i,   var e_i = v_i known,   var u_i = tau^2 by Paule and Mandel
//
// mu is the mean weighted by 1 / (v_i + tau^2). Where tau^2 had to be estimated, the variance of mu
// rests on the scatter of n groups and its interval is Student's with few degrees of freedom:
//   (n - 1) sqrt(var mu / the part of it that tau^2 makes),
// n - 1 when the scatter is all there is (Hartung and Knapp). Always n - 1 covers 97.7 % for three
// groups that agree, Welch and Satterthwaite's power 2 in place of 1/2 only 89 % where the scatter
// is of the size of the v_i; 1/2 keeps between 92 and 97.5 % (random_effects_test.cc). Sources:
// Paule and Mandel, J. Res. NBS 87 (1982) 377; Hartung and Knapp, Statist. Med. 20 (2001) 3875;
// Cochran, Biometrics 10 (1954) 101.
#pragma once

#include <span>
#include <vector>

namespace rigfit::ident {

struct RandomEffects {
  double mean = 0;
  double variance = 0;          ///< of the mean
  double between_variance = 0;  ///< tau^2; 0: the groups agree within their own uncertainty
  double cochran_Q = 0;         ///< chi-squared with n - 1 degrees of freedom when tau is 0
  double degrees = 0;           ///< of `variance`; 0: the v_i, taken as known, are all there is
  std::vector<double> weights;  ///< sum 1
};

/// `variances` positive, as many as `values`, at least one.
[[nodiscard]] RandomEffects pool_groups(std::span<const double> values,
                                        std::span<const double> variances);

}  // namespace rigfit::ident
