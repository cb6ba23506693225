#include "signal/decay/decay_window.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <tuple>
#include <utility>

#include "signal/decay/decay_hits.h"
#include "signal/numerics/numbers.h"
#include "signal/sinusoids/decay_search.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

struct Onset {
  Index start = 0;
  double energy = 0;      // taken out from there on
  double from_first = 0;  // the most that any decay from sample 0 takes out
};

// Best start for a sinusoid of frequency w over a bank of decay rates.
Onset best_onset(const Eigen::VectorXd& y, double w) {
  const Index n = y.size();
  Onset onset;
  for (double decays = 2; decays / static_cast<double>(n) < 0.5 * w; decays *= 2.5) {
    const double a = decays / static_cast<double>(n);
    const Complex q = std::exp(Complex(-a, -w));
    const double q2 = std::exp(-2 * a);
    Complex sum = 0;
    double energy = 0;
    for (Index s = n - 1; s >= 0; --s) {
      const double re = sum.real() * q.real() - sum.imag() * q.imag() + y(s);
      sum = Complex(re, sum.real() * q.imag() + sum.imag() * q.real());
      energy = 1 + q2 * energy;
      const double taken = 2 * std::norm(sum) / energy;
      if (taken > onset.energy) onset.energy = taken, onset.start = s;
      if (s == 0) onset.from_first = std::max(onset.from_first, taken);
    }
  }
  return onset;
}

// Whether what lies before an onset is small beside what follows: a beat that swells is not. Other
// modes may shift the onset by a cycle, which is left out where there are three more before it.
bool quiet_before(const Eigen::VectorXd& y, double w, Index start, Index cycle) {
  const RunningAmplitude running(y, w);
  const double after = std::abs(running.over(start, start + cycle));
  const Index until = start < 4 * cycle ? start : start - cycle;
  for (Index j = 0; j + cycle <= until; j += cycle / 2) {
    if (std::abs(running.over(j, j + cycle)) > 0.3 * after) return false;
  }
  return true;
}

}  // namespace

Index recorded_until(const Eigen::Ref<const Eigen::VectorXd>& y) {
  constexpr Index kFewest = 16;
  const Index n = y.size();
  Index tail = 1;
  while (tail < n && y(n - 1 - tail) == y(n - 1)) ++tail;
  if (tail < kFewest || tail == n) return n;
  double step = std::numeric_limits<double>::infinity();
  for (Index j = 1; j < n - tail; ++j) {
    if (y(j) != y(j - 1)) step = std::min(step, std::abs(y(j) - y(j - 1)));
  }
  const auto before =
      y.segment(std::max<Index>(0, n - tail - kFewest), std::min(kFewest, n - tail));
  return (before.array() - y(n - 1)).abs().maxCoeff() <= 2 * step ? n : n - tail;
}

std::vector<DecayWindow> find_decays(const Eigen::Ref<const Eigen::VectorXd>& samples,
                                     const DecayBand& band) {
  const Index n = recorded_until(samples);
  const auto y = samples.head(n);
  const Eigen::VectorXd x = without_trend(y);
  if (n < 16 || !(x.squaredNorm() > 0)) return {{0, n}};
  auto candidates = search_decays(x, {.candidates = 64});
  std::erase_if(candidates, [&](const DecayCandidate& c) { return !band.contains(c.pole); });
  if (candidates.empty()) return {{0, n}};
  candidates.resize(std::min<std::size_t>(4, candidates.size()));

  // The candidate that gains most by starting later tells where the event is; hum gains nothing.
  // Where many modes sum, the onset of some is found late: those that are quiet before come first.
  Index onset = 0;
  bool quiet = false;
  double gain = 0, w = candidates.front().pole.imag();
  std::vector<double> strong;
  for (const auto& c : candidates) {
    if (c.energy < 0.05 * candidates.front().energy) break;
    const double each = c.pole.imag();
    strong.push_back(each);
    const Onset best = best_onset(x, each);
    const double now = best.energy - best.from_first;
    const Index cycle = averaging_cycle(each);
    const bool late = now > detection_threshold(n, 1e-6) * c.noise_variance &&
                      now > 0.1 * best.energy && best.start > cycle && n - best.start > 3 * cycle;
    const std::pair found(late && quiet_before(x, each, best.start, cycle), now);
    if (found > std::pair(quiet, gain)) std::tie(quiet, gain) = found, onset = best.start, w = each;
  }
  const Index cycle = averaging_cycle(w);
  std::iter_swap(strong.begin(), std::ranges::find(strong, w));
  std::vector<Index> starts = further_hits(y, strong);
  // A record that was cut off at a rail and comes off it steps its amplitude too.
  const double high = y.maxCoeff<Eigen::PropagateNumbers>();
  const double low = y.minCoeff<Eigen::PropagateNumbers>();
  std::erase_if(starts, [&](Index start) {
    const Index reach = std::min(start, 8 * cycle);
    const auto before = y.segment(start - reach, reach).array();
    return (before == high).count() > 1 || (before == low).count() > 1;
  });
  if (quiet) {  // better placed than a jump is
    std::erase_if(starts, [&](Index start) { return std::abs(start - onset) < 4 * cycle; });
    starts.push_back(onset);
  }
  std::sort(starts.begin(), starts.end());
  // A decay that the record begins with.
  const RunningAmplitude running(x, w);
  if (starts.empty() ||
      (!(quiet && starts.front() >= onset - 4 * cycle) && starts.front() > 4 * cycle &&
       std::abs(running.over(0, 2 * cycle)) > 0.1 * running.largest(cycle))) {
    starts.insert(starts.begin(), 0);
  }
  std::vector<DecayWindow> windows;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    const Index start = starts[k];
    const Index end = k + 1 < starts.size() ? std::max(starts[k + 1] - 2 * cycle, start + 1) : n;
    // An impact lasts: half a cycle is left to it (more where the fit then shows so).
    const auto lasts = static_cast<Index>(start > 0 ? std::ceil(0.5 * kTwoPi / w) : 0);
    windows.push_back({std::min(start + lasts, end - 1), end});
  }
  return windows;
}

}  // namespace rigfit::signal
