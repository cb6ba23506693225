// Damped sinusoids on a background, fitted by least squares to samples or to the lines of a band.
//
//   y(t) = sum_m Re(C_m exp(p_m t)) + c0 + c1 t / N [+ b exp(-r t)] + e,   p = -a + i w a sample
//
// Samples at even times without gaps are fitted by their discrete Fourier transform over the whole
// stretch, at the lines k of a band only. There a damped sinusoid is exactly
//   sum_j exp((p - i w_k) j) = (exp(p N) - 1) / (exp(p - i w_k) - 1),
// white noise is white, and what lies outside of the band is smooth within it: three terms of a
// polynomial in frequency hold it. With all lines this is least squares in time (Parseval). Samples
// with gaps or at uneven times are fitted as they are, without those that are missing.
// Variable projection: for given poles the amplitudes and the background are linear; the poles move
// by Gauss-Newton steps on the projected functional (Kaufman's form), damped after Levenberg and
// Marquardt. A step costs rows x parameters^2. The covariance is the sandwich
//   A (sum_k J_k' J_k S_k) A,   A = (J'J)^-1,
// with S_k the residual's density around line k: noise of any colour. Sources: Golub and Pereyra,
// SIAM J. Numer. Anal. 10 (1973) 413; Kaufman, BIT 15 (1975) 49; White, Econometrica 48 (1980) 817.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <span>
#include <vector>

namespace rigfit::signal {

/// The stretch of a record that is fitted.
struct DecaySamples {
  Eigen::VectorXd t;      ///< of the samples present, in samples since the first; rising
  Eigen::VectorXd y;      ///< their values
  Eigen::Index span = 0;  ///< samples of the stretch at an even rate, missing ones too
  bool even = true;       ///< t are whole numbers

  [[nodiscard]] bool complete() const { return even && t.size() == span; }
  /// At even times, the straight line of least squares taken off: 0 where missing, between the
  /// neighbours where times are uneven.
  [[nodiscard]] Eigen::VectorXd trendless() const;
};

/// Samples at even times, those that are not finite left out.
[[nodiscard]] DecaySamples even_samples(const Eigen::Ref<const Eigen::VectorXd>& y);

struct DampedSinusoidsOptions {
  double low = 0, high = 0.5;        ///< lines that are fitted, cycles per sample
  int max_iterations = 60;           ///< steps, taken or refused
  double step_in_std = 1e-3;         ///< stop at a step this small in standard uncertainties
  std::optional<double> relaxation;  ///< start of r, a sample: the background has b exp(-r t)
};

struct DampedSinusoidsFit {
  std::vector<std::complex<double>> poles;       ///< per sample
  std::vector<std::complex<double>> amplitudes;  ///< C at t = 0
  double offset = 0;                             ///< at t = 0
  double drift = 0;                              ///< over the whole of N samples
  std::optional<double> relaxation;              ///< r, a sample
  double relaxation_amplitude = 0;               ///< b
  double residual_sum_squares = 0;               ///< over the lines fitted
  Eigen::Index samples = 0;                      ///< N, with the missing ones
  Eigen::Index degrees = 0;                      ///< real values fitted less parameters
  Eigen::VectorXd residual;         ///< N at even times, within the band; 0 where missing
  Eigen::MatrixXd unit_covariance;  ///< (J'J)^-1 of (Re C, Im C, Re p, Im p) a mode; empty: the
                                    ///< parameters cannot be told apart
  Eigen::MatrixXd covariance;       ///< the sandwich
  std::vector<double> noise;        ///< S at each mode: variance of white noise of that density
  std::vector<double> energy;  ///< rise of the sum of squares without the mode, other poles kept
  double low = 0, high = 0.5;  ///< lines that were fitted, cycles per sample
  double noise_degrees = 0;    ///< that S is known by
  bool converged = false;

  [[nodiscard]] bool usable() const { return unit_covariance.size() > 0; }
  [[nodiscard]] double variance() const {
    return residual_sum_squares / static_cast<double>(std::max<Eigen::Index>(1, degrees));
  }
  /// Mode m alone at every sample.
  [[nodiscard]] Eigen::VectorXd mode_signal(std::size_t m) const;
};

/// Fits from the starting poles. A fit with fewer values than parameters is not usable.
[[nodiscard]] DampedSinusoidsFit fit_damped_sinusoids(const DecaySamples& samples,
                                                      std::span<const std::complex<double>> poles,
                                                      const DampedSinusoidsOptions& options = {});

}  // namespace rigfit::signal
