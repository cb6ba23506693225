#include "signal/decay/decay_start.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "signal/numerics/numbers.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// How far the start should move: while the first half cycle leaves three times the rms of the rest.
Index start_shift(const DampedSinusoidsFit& fit, std::size_t strongest) {
  const Complex pole = fit.poles[strongest];
  const double cycle = kTwoPi / pole.imag();
  const auto half = std::max<Index>(3, static_cast<Index>(std::lround(0.5 * cycle)));
  const auto rest_from = static_cast<Index>(std::ceil(2 * cycle));
  if (fit.samples < rest_from + std::max<Index>(8, static_cast<Index>(3 * cycle))) return 0;
  const auto rest = fit.residual.tail(fit.samples - rest_from);
  const double level = rest.squaredNorm() / static_cast<double>(rest.size());
  return fit.residual.head(half).squaredNorm() > 9 * level * static_cast<double>(half) ? half : 0;
}

}  // namespace

std::optional<DecayStart> later_start(const Eigen::Ref<const Eigen::VectorXd>& y, Index start,
                                      Index end, const DampedSinusoidsFit& fit,
                                      const DecayBand& band, const DecayModesOptions& options) {
  const Complex pole = fit.poles[strongest_mode(fit, band)];
  const double most = std::min(3 * kTwoPi / pole.imag(), 0.35 / std::max(-pole.real(), 1e-300));
  // The start that a fit asks for, or its own.
  const auto next_of = [&](const DampedSinusoidsFit& found, Index own) {
    const Index next = own + start_shift(found, strongest_mode(found, band));
    return static_cast<double>(next - start) > most ? own : next;
  };
  const auto search = [&](Index from) -> std::optional<DecayStart> {
    DecayStart at{from, decay_samples(y, from, end), {}};
    auto found = find_decay_modes(at.samples, band, options);
    if (!found) return std::nullopt;
    at.fit = std::move(*found);
    return at;
  };

  std::optional<DecayStart> best;
  Index from = start;
  DampedSinusoidsFit known = fit;
  while (next_of(known, from) != from) {
    // `from` will not do: how far the modes known would go, refitted.
    std::vector<Index> starts{from};
    for (Index next; (next = next_of(known, starts.back())) != starts.back();) {
      starts.push_back(next);
      const DecaySamples samples = decay_samples(y, next, end);
      const auto present = samples.values.size() - static_cast<Index>(samples.missing.size());
      if (present <= static_cast<Index>(4 * known.poles.size() + 2)) break;
      known = fit_damped_sinusoids(samples.values, known.poles, {}, samples.missing);
      if (known.unit_covariance.size() == 0) break;
    }
    std::optional<DecayStart> found;
    std::size_t k = starts.size();
    while (k > 1 && !found) found = search(starts[--k]);
    if (!found) break;
    const bool more = k + 1 == starts.size() && next_of(found->fit, found->start) != found->start;
    while (!more && k > 1) {
      auto earlier = search(starts[--k]);
      if (!earlier || next_of(earlier->fit, earlier->start) != earlier->start) break;
      found = std::move(earlier);
    }
    best = std::move(found);
    if (!more) break;
    from = best->start;
    known = best->fit;
  }
  return best;
}

}  // namespace rigfit::signal
