#include "signal/decay/narrow_record.h"

#include <gsl/gsl_sf_bessel.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "signal/decay/decay_window.h"
#include "signal/recording/clipping.h"
#include "signal/spectra/fft.h"
#include "signal/spectra/window.h"

namespace rigfit::signal {
namespace {

using Eigen::Index;

// Kaiser's window of 100 dB, whose transition is 0.2 of the narrow rate: (100 - 7.95) / (14.36 0.2)
// narrow samples in all.
constexpr double kKaiser = 0.1102 * (100 - 8.7);
constexpr Index kReach = 16;
constexpr double kUnchanged = 0.4;
// A blow is spread over the filter's reach, which is half a cycle at the end of the band then.
constexpr double kSamplesPerCycle = 32;
constexpr Index kLeastStep = 4, kFewestNarrow = 8 * kReach;
// Blocks of the spectra, samples; lines on either side that the noise is read from, of the offset
// and its drift, and that Hann's window spreads a tone over.
constexpr Index kSpectrumBlock = Index{1} << 15, kAround = 64, kOffsetLines = 4, kSpread = 4;

/// Highest frequency below `high` at which something stands out of the noise around it, cycles per
/// sample; 0: nothing does.
double highest_line(const Eigen::Ref<const Eigen::VectorXd>& y, double high) {
  const Index size = std::min(kSpectrumBlock, good_fft_length_below(y.size() / 16));
  RealFft fft(size);
  const Eigen::ArrayXd window = hann_window(size);
  Eigen::ArrayXd mean = Eigen::ArrayXd::Zero(fft.lines()), most = mean;
  const Index blocks = y.size() / size;
  for (Index b = 0; b < blocks; ++b) {
    const auto block = y.segment(b * size, size).array();
    fft.time() = (block - block.mean()) * window;
    fft.forward();
    const Eigen::ArrayXd power = fft.spectrum().array().abs2();
    mean += power / static_cast<double>(blocks), most = most.max(power);
  }
  const double of_mean = 1 + 10 / std::sqrt(static_cast<double>(blocks));
  const double of_most = std::log(0.5 * static_cast<double>(y.size()) / 1e-6);
  std::vector<double> around;
  const auto last = std::min<Index>(mean.size() - 1, std::lround(high * static_cast<double>(size)));
  for (Index k = last; k > kOffsetLines; --k) {
    around.assign(mean.data() + std::max(kOffsetLines, k - kAround),
                  mean.data() + std::min(mean.size(), k + kAround));
    const auto middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
    std::nth_element(around.begin(), middle, around.end());
    if (mean(k) > of_mean * *middle || most(k) > of_most * *middle) {
      return static_cast<double>(k + kSpread) / static_cast<double>(size);
    }
  }
  return 0;
}

Eigen::VectorXd low_pass(Index step) {
  const Index reach = kReach * step;
  Eigen::VectorXd h(2 * reach + 1);
  for (Index k = -reach; k <= reach; ++k) {
    const double x = static_cast<double>(k) / static_cast<double>(reach);
    const double angle = std::numbers::pi * static_cast<double>(k) / static_cast<double>(step);
    h(k + reach) =
        (k == 0 ? 1 : std::sin(angle) / angle) * gsl_sf_bessel_I0(kKaiser * std::sqrt(1 - x * x));
  }
  return h / h.sum();
}

}  // namespace

std::optional<NarrowRecord> narrow_record(const Eigen::Ref<const Eigen::VectorXd>& y,
                                          const DecayBand& band, Index long_from) {
  double high = band.high;
  Index step = band.all ? 1 : static_cast<Index>(1 / (kSamplesPerCycle * high));
  if (step < kLeastStep && y.size() >= long_from) {
    high = highest_line(y, band.high);
    if (!(high > 0)) return {};
    step = std::min(static_cast<Index>(kUnchanged / high), 4 * y.size() / long_from);
  }
  if (step < kLeastStep || y.size() <= 2 * kReach * step) return {};
  NarrowRecord out;
  out.step = step, out.first = kReach * step;
  const Index count = (y.size() - 1 - 2 * out.first) / step + 1;
  if (count < kFewestNarrow) return {};
  if (!y.allFinite() || recorded_until(y) < y.size() || clipped_samples(y, 0).count > 0) return {};
  const Eigen::VectorXd h = low_pass(step);
  out.samples.resize(count);
  for (Index i = 0; i < count; ++i) out.samples(i) = h.dot(y.segment(i * step, h.size()));
  return out;
}

}  // namespace rigfit::signal
