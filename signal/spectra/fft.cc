#include "signal/spectra/fft.h"

#include <fftw3.h>

#include <cassert>
#include <mutex>

namespace rigfit::signal {

namespace {

/// The plan for a length and direction, made when it is first wanted and kept until the program
/// ends. FFTW's planner is not thread-safe; executing a plan on other arrays of the same alignment
/// is.
fftw_plan plan_of(VectorXd& time, fftw_complex* spectrum, bool inverse) {
  static std::mutex mutex;
  static auto& plans = *new std::map<std::pair<Index, bool>, fftw_plan>;  // outlives all threads
  const std::lock_guard lock(mutex);
  fftw_plan& plan = plans[{time.size(), inverse}];
  const int n = static_cast<int>(time.size());
  if (plan == nullptr) {
    plan = inverse ? fftw_plan_dft_c2r_1d(n, spectrum, time.data(), FFTW_ESTIMATE)
                   : fftw_plan_dft_r2c_1d(n, time.data(), spectrum,
                                          FFTW_ESTIMATE | FFTW_PRESERVE_INPUT);
  }
  return plan;
}

bool has_small_factors(Index n) {
  for (const Index factor : {2, 3, 5}) {
    while (n % factor == 0) n /= factor;
  }
  return n == 1;
}

}  // namespace

struct RealFft::State {
  explicit State(Index n) : time(n), spectrum(n / 2 + 1) {}
  fftw_complex* lines() { return reinterpret_cast<fftw_complex*>(spectrum.data()); }

  VectorXd time;  // aligned to 16 bytes, as FFTW likes it
  VectorXcd spectrum;
};

RealFft::RealFft(Index length) {
  if (length < 1 || length > 1'000'000'000) {
    throw std::invalid_argument("a transform has between 1 and 1e9 samples");
  }
  state_ = std::make_unique<State>(length);
}
RealFft::~RealFft() = default;
RealFft::RealFft(RealFft&&) noexcept = default;
RealFft& RealFft::operator=(RealFft&&) noexcept = default;

Index RealFft::length() const { return state_->time.size(); }

Map<VectorXd> RealFft::time() { return {state_->time.data(), length()}; }

Map<VectorXcd> RealFft::spectrum() { return {state_->spectrum.data(), lines()}; }

void RealFft::forward() {
  fftw_execute_dft_r2c(plan_of(state_->time, state_->lines(), false), state_->time.data(),
                       state_->lines());
}

void RealFft::inverse() {
  fftw_execute_dft_c2r(plan_of(state_->time, state_->lines(), true), state_->lines(),
                       state_->time.data());
  state_->time /= static_cast<double>(length());
}

MatrixXcd real_spectra(const Ref<const MatrixXd>& signals, Index length) {
  RealFft fft(length);
  const Index take = std::min(length, signals.rows());
  MatrixXcd spectra(fft.lines(), signals.cols());
  for (Index c = 0; c < signals.cols(); ++c) {
    fft.time().head(take) = signals.col(c).head(take);
    fft.time().tail(length - take).setZero();
    fft.forward();
    spectra.col(c) = fft.spectrum();
  }
  return spectra;
}

VectorXd line_frequencies(Index length, double sample_rate_hz) {
  const Index lines = length / 2 + 1;
  return VectorXd::LinSpaced(lines, 0, static_cast<double>(lines - 1)) *
         (sample_rate_hz / static_cast<double>(length));
}

Index good_fft_length(Index n) {
  Index length = std::max<Index>(2, n + n % 2);
  while (!has_small_factors(length)) length += 2;
  return length;
}

Index good_fft_length_below(Index n) {
  assert(n >= 2);
  Index length = n - n % 2;
  while (!has_small_factors(length)) length -= 2;
  return length;
}

}  // namespace rigfit::signal
