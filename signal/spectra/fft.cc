#include "signal/spectra/fft.h"

#include <fftw3.h>

#include <cassert>
#include <map>
#include <mutex>
#include <stdexcept>
#include <utility>

namespace rigfit::signal {
using Eigen::Index;

struct FftPlans {
  fftw_plan forward = nullptr;
  fftw_plan inverse = nullptr;
};

namespace {

/// One pair of plans for each length in use, kept until the program ends.
struct PlanCache {
  std::mutex mutex;
  std::map<Index, FftPlans> plans;

  PlanCache() = default;
  PlanCache(const PlanCache&) = delete;
  PlanCache& operator=(const PlanCache&) = delete;
  ~PlanCache() {
    for (auto& [length, pair] : plans) {
      if (pair.forward != nullptr) fftw_destroy_plan(pair.forward);
      if (pair.inverse != nullptr) fftw_destroy_plan(pair.inverse);
    }
    fftw_cleanup();
  }
};

/// FFTW's planner is not thread-safe; executing a plan on other arrays of the same alignment is.
/// The plan inverse is made when it is first wanted: its tables take as long as a transform.
fftw_plan plan_of(Eigen::VectorXd& time, fftw_complex* spectrum, bool inverse) {
  static PlanCache cache;
  const std::lock_guard lock(cache.mutex);
  const int n = static_cast<int>(time.size());
  FftPlans& plans = cache.plans[time.size()];
  if (inverse && plans.inverse == nullptr) {
    plans.inverse = fftw_plan_dft_c2r_1d(n, spectrum, time.data(), FFTW_ESTIMATE);
  } else if (!inverse && plans.forward == nullptr) {
    plans.forward =
        fftw_plan_dft_r2c_1d(n, time.data(), spectrum, FFTW_ESTIMATE | FFTW_PRESERVE_INPUT);
  }
  return inverse ? plans.inverse : plans.forward;
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

  Eigen::VectorXd time;  // aligned to 16 bytes, as FFTW likes it
  Eigen::VectorXcd spectrum;
  FftPlans plans;  // those that this object has used
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

Eigen::Map<Eigen::VectorXd> RealFft::time() { return {state_->time.data(), length()}; }

Eigen::Map<Eigen::VectorXcd> RealFft::spectrum() { return {state_->spectrum.data(), lines()}; }

void RealFft::forward() {
  fftw_plan& plan = state_->plans.forward;
  if (plan == nullptr) plan = plan_of(state_->time, state_->lines(), false);
  fftw_execute_dft_r2c(plan, state_->time.data(), state_->lines());
}

void RealFft::inverse() {
  fftw_plan& plan = state_->plans.inverse;
  if (plan == nullptr) plan = plan_of(state_->time, state_->lines(), true);
  fftw_execute_dft_c2r(plan, state_->lines(), state_->time.data());
  state_->time /= static_cast<double>(length());
}

Eigen::MatrixXcd real_spectra(const Eigen::Ref<const Eigen::MatrixXd>& signals, Index length) {
  RealFft fft(length);
  const Index take = std::min(length, signals.rows());
  Eigen::MatrixXcd spectra(fft.lines(), signals.cols());
  for (Index c = 0; c < signals.cols(); ++c) {
    fft.time().head(take) = signals.col(c).head(take);
    fft.time().tail(length - take).setZero();
    fft.forward();
    spectra.col(c) = fft.spectrum();
  }
  return spectra;
}

Eigen::VectorXd line_frequencies(Index length, double sample_rate_hz) {
  const Index lines = length / 2 + 1;
  return Eigen::VectorXd::LinSpaced(lines, 0, static_cast<double>(lines - 1)) *
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
