#include "signal/decay/decay_steps.h"

#include "signal/decay/decay_window.h"
#include "signal/numerics/low_pass.h"
#include "signal/recording/clipping.h"

namespace rigfit::signal {
namespace {

// A blow is spread over the filter's reach, which is half a cycle at the end of the band then.
constexpr double kSamplesPerCycle = 8;

}  // namespace

std::optional<NarrowRecord> narrow_record(const Ref<const VectorXd>& y, const DecayBand& band) {
  // Records of 130 narrow samples still start where whole ones do, those of 80 start before they
  // are struck (narrow_record_test.cc): twice as many.
  constexpr Index kFewest = 256;
  NarrowRecord out;
  if (band.all) return {};
  out.step = std::min(static_cast<Index>(1 / (kSamplesPerCycle * band.high)), y.size() / kFewest);
  if (out.step < 2) return {};
  const double narrow = 1 / static_cast<double>(out.step), band_end = narrow / kSamplesPerCycle;
  // What lies beyond the stop band's edge would be folded into the band; 4.3 narrow samples to
  // either side.
  const LowPass filter(band_end, narrow - band_end, 100);
  out.first = static_cast<Index>(filter.half_length());
  if (y.size() <= 2 * out.first) return {};
  if (!y.allFinite() || recorded_until(y) < y.size() || clipped_samples(y, 0).count > 0) return {};
  VectorXd h = VectorXd::NullaryExpr(
      2 * out.first + 1, [&](Index k) { return filter.at(static_cast<double>(k - out.first)); });
  h /= h.sum();
  out.noise_gain = h.norm();
  out.samples.resize((y.size() - 1 - 2 * out.first) / out.step + 1);
  for (Index i = 0; i < out.samples.size(); ++i) {
    out.samples(i) = h.dot(y.segment(i * out.step, h.size()));
  }
  return out;
}

}  // namespace rigfit::signal
