// Discrete Fourier transforms of real signals.
//
//   X_k = sum_n x_n exp(-2 pi i k n / N),   k = 0 .. N/2   (one-sided, unscaled)
//   x_n = (1/N) sum_k X_k exp(+2 pi i k n / N)             (inverse, X_-k = conj X_k)
// Computed by FFTW 3, planned without timing trials so that the same input gives the same bits in
// every run.
#pragma once

#include <memory>

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

/// Transform of one length. Plans are kept for the life of the program and shared by all objects
/// and threads; an object owns its work space, so use one object a thread.
class RealFft {
 public:
  explicit RealFft(Index length);  ///< samples, at least 1
  ~RealFft();
  RealFft(RealFft&&) noexcept;
  RealFft& operator=(RealFft&&) noexcept;

  [[nodiscard]] Index length() const;
  [[nodiscard]] Index lines() const { return length() / 2 + 1; }

  /// Work space that `forward()` reads and `inverse()` writes: `length()` samples.
  [[nodiscard]] Map<VectorXd> time();
  /// Work space that `forward()` writes and `inverse()` reads: `lines()` values.
  [[nodiscard]] Map<VectorXcd> spectrum();

  /// time() -> spectrum(); time() is kept.
  void forward();
  /// spectrum() -> time(), scaled by 1/N; spectrum() is overwritten.
  void inverse();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Columns of `signals` (samples x channels), zero-padded or cut to `length`, to lines x channels.
[[nodiscard]] MatrixXcd real_spectra(const Ref<const MatrixXd>& signals, Index length);

/// Frequencies of the lines of a transform of `length` samples, Hz.
[[nodiscard]] VectorXd line_frequencies(Index length, double sample_rate_hz);

/// Smallest length >= n whose only prime factors are 2, 3 and 5, and which is even.
[[nodiscard]] Index good_fft_length(Index n);
/// Largest such length <= n (n >= 2).
[[nodiscard]] Index good_fft_length_below(Index n);

}  // namespace rigfit::signal
