// Damped sinusoids on an offset and a drift, fitted to uniform samples by least squares.
//
//   y_j = sum_m Re(C_m exp(p_m j)) + c0 + c1 j / N + e_j,   p_m = -a_m + i w_m per sample
//
// Variable projection: for given poles the complex amplitudes C and the background are linear and
// solved exactly; the poles move by the steps of estimation/pole_steps.h. Every Gram matrix is a
// sum of j^k q^j, evaluated by doubling in O(log N); only the products with the data cost O(N).
// With white Gaussian noise this is the maximum-likelihood estimate and reaches the Cramer-Rao
// bound. A pole on an axis stays on it: one whose real part is 0 is a steady tone, one whose
// imaginary part is 0 (its amplitude real) an offset that dies away.
#pragma once

#include "signal/estimation/pole_steps.h"

namespace rigfit::signal {

/// What other samples say of a steady tone.
struct KnownTone {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();        ///< Re C, Im C and Im p
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< inverse of their unit covariance

  /// The same, C that of the sample `later`.
  [[nodiscard]] KnownTone at(Index later) const;
};

struct DampedSinusoidsOptions {
  int background_terms = 2;  ///< 0: none, 1: offset, 2: offset and drift
  int max_iterations = 60;   ///< steps, taken or refused
  /// The last step, in standard uncertainties. Gauss and Newton's steps creep where noise is
  /// strong: 1e-3 takes 1.2 times as long in tests/bench/decay_truth.
  double step_in_std = 1e-2;
  /// What is known of the first poles, where they are tones: counts as three more samples each.
  std::span<const KnownTone> known;
};

struct DampedSinusoidsFit {
  std::vector<Complex> poles;       ///< per sample
  std::vector<Complex> amplitudes;  ///< C at sample 0
  double offset = 0;                ///< at sample 0
  double drift = 0;                 ///< over the whole of N samples
  double residual_sum_squares = 0;
  Index samples = 0;  ///< N, with the missing ones
  Index degrees = 0;  ///< samples present less free parameters
  VectorXd residual;  ///< N; 0 where missing
  std::vector<Index> missing;
  MatrixXd jacobian_gram;  ///< J'J, parameters (Re C, Im C, Re p, Im p) per mode, then c0, c1
  /// (J'J)^-1 of the free parameters, 0 for the others; empty when rank-deficient.
  MatrixXd unit_covariance;
  int iterations = 0;
  StepsEnd end = StepsEnd::iteration_limit;  ///< rank-deficient: no covariance
  /// Poles that find_decay_modes() took out again, since noise passes for them.
  std::vector<Complex> noise_like = {};
  /// Modes up to here, radians per sample, are no more than a drift that does not oscillate.
  double drift_up_to = 0;

  /// Mode m alone at every sample.
  [[nodiscard]] VectorXd mode_signal(std::size_t m) const;
  /// What modes and background change by from the time `j` to `late` samples behind it.
  [[nodiscard]] double change(double j, double late) const;
  /// All modes on the background, at every sample.
  [[nodiscard]] VectorXd signal() const;
  /// `count` rows of J from `first` on; columns in the order of `jacobian_gram`.
  [[nodiscard]] MatrixXd jacobian_rows(Index first, Index count) const;
};

[[nodiscard]] constexpr bool is_tone(Complex pole) { return pole.real() == 0; }
[[nodiscard]] constexpr bool is_offset(Complex pole) { return pole.imag() == 0; }

/// Time constants over the record of a start that is no steady tone.
inline constexpr double kFreeDecay = 1e-6;

/// Fits `y` from the starting poles (per sample). `missing` lists samples to leave out (y there
/// must be 0). Needs more samples than parameters, else std::invalid_argument.
[[nodiscard]] DampedSinusoidsFit fit_damped_sinusoids(const Ref<const VectorXd>& y,
                                                      std::span<const Complex> poles,
                                                      const DampedSinusoidsOptions& options = {},
                                                      std::span<const Index> missing = {});

}  // namespace rigfit::signal
