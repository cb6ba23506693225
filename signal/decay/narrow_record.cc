#include "signal/decay/narrow_record.h"

#include <gsl/gsl_sf_bessel.h>

#include <cmath>
#include <numbers>

#include "signal/decay/decay_window.h"
#include "signal/recording/clipping.h"

namespace rigfit::signal {
namespace {

using Eigen::Index;

// Kaiser's window of 100 dB, whose transition is 0.2 of the narrow rate: (100 - 7.95) / (14.36 0.2)
// narrow samples in all.
constexpr double kKaiser = 0.1102 * (100 - 8.7);
constexpr Index kReach = 16;
// A blow is spread over the filter's reach, which is half a cycle at the end of the band then.
constexpr double kSamplesPerCycle = 32;
constexpr Index kLeastStep = 4, kFewestNarrow = 8 * kReach;

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
                                          const DecayBand& band) {
  const Index step = band.all ? 1 : static_cast<Index>(1 / (kSamplesPerCycle * band.high));
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
