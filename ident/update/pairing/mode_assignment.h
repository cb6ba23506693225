// Assigns modelled modes to measured ones by probability.
//
// A test that looked at a band of frequencies sees a modelled mode j with the probability
//
//   P_j = (1 - missed) (leaked + (1 - leaked) v_j)
//
// with v_j in 0..1 the visibility from the test's driving and response points, 0 for a mode of the
// other plane. The logarithm of the likelihood of an assignment is the sum of
//
//   pair (i, j):        ln (1 - false) + ln P_j + ln N(ln(f_j / f_i); 0, s_i) [+ ln p(MAC_ij)]
//   measured, unpaired: ln false, the density of false modes over ln f
//   modelled, unpaired: ln (1 - P_j) inside the band; 0 outside, where the test did not look
//
// with p(MAC) = exp(-(1 - MAC) / m) / (m (1 - exp(-1 / m))) for the right shape and 1 for a wrong
// one, MAC after Allemang (2003). The assignment of the largest likelihood comes from the Hungarian
// method (Kuhn 1955). The band goes from 0 (or from where the test began) to the highest measured
// mode: a modal test begins at the lowest modes, so that a model with visible modes below all
// measured ones is charged for them. A model that is too soft has many such modes.
// Sources: Bar-Shalom and Fortmann, Tracking and Data Association, 1988, ch. 9; Beck and
// Katafygiotis, J. Eng. Mech. 124 (1998) 455.
#pragma once

#include "ident/statistics/numbers.h"
#include "model/linear/modal_analysis.h"

namespace rigfit::ident {

struct PairingMode {
  double frequency_hz = 0;
  std::optional<model::ModePlane> plane = std::nullopt;  ///< measured: the plane of the test
  VectorXcd shape = {};   ///< at the same points on both sides; empty: not known
  double visibility = 1;  ///< how well a modelled mode is seen
  int order = 0;  ///< among the modes of its plane, from 1; measured: as stated, 0 where it is not
};

struct ModePair {
  int measured = 0, model = 0;  ///< indices of the input
  double mac = kNaN;
  bool cross_plane = false;  ///< leakage: the modelled mode lies in another plane than the test
};

/// |a^H b|^2 / (a^H a b^H b), 0..1; NaN when either is empty, zero, of another length, or too short
/// (one point) to say anything.
[[nodiscard]] double shape_correlation(const Ref<const VectorXcd>& a,
                                       const Ref<const VectorXcd>& b);

/// Column of each row in an assignment of least total cost; rows x columns with rows <= columns.
[[nodiscard]] std::vector<int> least_cost_assignment(const Ref<const MatrixXd>& cost);

struct AssignmentOptions {
  double missed = 0.1;       ///< probability that a test misses a mode that it can see
  double false_mode = 0.05;  ///< probability that a measured mode is not the structure's
  /// Probability that a mode shows up that the test should not see: a mode of the other plane, or
  /// one with its nodes at the points of the test.
  double leaked = 0.1;
  /// Response relative to the band's strongest mode at which a mode is half visible (a dynamic
  /// range of 30 dB).
  double visible_ratio = 0.03;
  double mac_scale = 0.2;  ///< m above
  /// Measured modes may lie beyond the band that was excited, such as hum: the band ends at the
  /// highest pair, whichever makes the likelihood largest.
  bool ends_at_pairs = false;
};

/// A modelled mode that the test should have seen if the structure had it.
struct MissedMode {
  int model = 0;           ///< index
  double probability = 0;  ///< that the test sees it
};

struct AssignmentLikelihood {
  double log_likelihood = 0;  ///< ln(likelihood) of pairs, false and missed modes
  /// Its parts: pairs without their normal densities, false modes, missed modes.
  double log_detected = 0, log_false = 0, log_missed = 0;

  [[nodiscard]] double without_densities() const { return log_detected + log_false + log_missed; }
  void add(const AssignmentLikelihood& other) {
    log_likelihood += other.log_likelihood;
    log_detected += other.log_detected;
    log_false += other.log_false;
    log_missed += other.log_missed;
  }
};

struct ModeAssignment : AssignmentLikelihood {
  std::vector<ModePair> pairs;  ///< by measured index
  std::vector<int> unpaired_measured;
  std::vector<MissedMode> missed;  ///< inside the band, probability 1/2 or more
};

/// `relative_std` is that of each measured frequency, the model's error included. `band_hz` is the
/// test's band; empty: from 0 to its highest measured mode. `PairingMode::visibility` of modelled
/// modes is a response amplitude in any unit; if all are 0 within a test's plane, all count as
/// visible.
[[nodiscard]] ModeAssignment assign_modes(const std::vector<PairingMode>& measured,
                                          const std::vector<double>& relative_std,
                                          const std::vector<PairingMode>& modelled,
                                          const std::optional<std::pair<double, double>>& band_hz,
                                          const AssignmentOptions& options);

/// Pairs for lists, by measured index: those of the assignment where every frequency may be 5 % off
/// and every mode of the test's plane is visible. A mode of the other plane that shows up in a test
/// is leakage (`cross_plane`).
[[nodiscard]] std::vector<ModePair> pair_modes(const std::vector<PairingMode>& measured,
                                               const std::vector<PairingMode>& modelled);
inline constexpr double kListStd = 0.05;

/// Relative accuracy of frequencies for vanishing segments that are compared: a hundredth of a
/// standard uncertainty of 1e-4.
inline constexpr double kComparedAccuracy = 1e-6;

}  // namespace rigfit::ident
