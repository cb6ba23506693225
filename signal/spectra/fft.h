// Discrete Fourier transforms of real signals.
//
//   X_k = sum_n x_n exp(-2 pi i k n / N),   k = 0 .. N/2   (one-sided, unscaled)
//   x_n = (1/N) sum_k X_k exp(+2 pi i k n / N)             (inverse, X_-k = conj X_k)
// Computed by FFTW 3, planned without timing trials so that the same input gives the same bits in
// every run.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <memory>
#include <span>

namespace rigfit::signal {

/// Transform of one length. Plans are kept for the life of the program and shared by all objects
/// and threads; an object owns its work space, so use one object a thread.
class RealFft {
 public:
  explicit RealFft(Eigen::Index length);  ///< samples, at least 1
  ~RealFft();
  RealFft(RealFft&&) noexcept;
  RealFft& operator=(RealFft&&) noexcept;

  [[nodiscard]] Eigen::Index length() const;
  [[nodiscard]] Eigen::Index lines() const { return length() / 2 + 1; }

  /// Work space that `forward()` reads and `inverse()` writes: `length()` samples.
  [[nodiscard]] Eigen::Map<Eigen::VectorXd> time();
  /// Work space that `forward()` writes and `inverse()` reads: `lines()` values.
  [[nodiscard]] Eigen::Map<Eigen::VectorXcd> spectrum();

  /// time() -> spectrum(); time() is kept.
  void forward();
  /// spectrum() -> time(), scaled by 1/N; spectrum() is overwritten.
  void inverse();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Columns of `signals` (samples x channels), zero-padded or cut to `length`, to lines x channels.
[[nodiscard]] Eigen::MatrixXcd real_spectra(const Eigen::Ref<const Eigen::MatrixXd>& signals,
                                            Eigen::Index length);

/// Frequencies of the lines of a transform of `length` samples, Hz.
[[nodiscard]] Eigen::VectorXd line_frequencies(Eigen::Index length, double sample_rate_hz);

/// Smallest length >= n whose only prime factors are 2, 3 and 5, and which is even.
[[nodiscard]] Eigen::Index good_fft_length(Eigen::Index n);
/// Largest such length <= n (n >= 2).
[[nodiscard]] Eigen::Index good_fft_length_below(Eigen::Index n);

}  // namespace rigfit::signal
