// Finds the free decays in a recording: each begins after an impact or release and lasts to
// the next impact or the end.
//
// The onset is the start s that maximises the energy a causal damped sinusoid takes out of the
// samples from s on, |sum_{j>=s} y_j exp(-(a + i w)(j - s))|^2 / energy of the exponential, which a
// backward recursion gives for all s in O(N), for several w and a. A record that decays from its
// first sample on is kept whole, whatever its noise. If a band is given, onset and impacts are
// those of the modes in it.
//
// Further impacts: where a decay ends because the next one starts. The complex amplitude of a mode,
// z(t), changes smoothly along a decay, along a beat and under friction; an impact steps it. With
// means over L cycles z_-2, z_-1 before and z_1, z_2 behind t, both sides are extrapolated to t by
// a straight line,
//   J(t) = (3 z_1 - z_2) / 2 - (3 z_-1 - z_-2) / 2,
// which for z = exp(-a t) is of third order in a L. Where |J| stands out, the damped sinusoids of
// a ten cycles before and behind are fitted apart and together. It is an impact when two fits
// explain more than one (Fisher's test) and the amplitudes of both, taken to t, differ by more than
// a twentieth of the record's largest, a loss that leaves the phase as it is (friction) aside.
// Where a side has more than three modes, whose beats look like blows, the motion must double
// besides. Missing samples are left out of these fits: a gap is no impact.
#include "signal/decay/decay_steps.h"

#include <gsl/gsl_cdf.h>

#include <tuple>

#include "signal/estimation/robust.h"
#include "signal/numerics/low_pass.h"
#include "signal/numerics/power_sums.h"
#include "signal/recording/clipping.h"
#include "signal/sinusoids/residual_noise.h"

namespace rigfit::signal {
namespace {

// Amplitudes under this share of the record's largest are no impact.
constexpr double kLeastShare = 0.05;
// Cycles on either side of an impact that are fitted.
constexpr Index kCycles = 10;
// Modes that such a stretch is given: with twelve one decay imitates a blow. Sides with more than
// half of them may beat.
constexpr int kModes = 6;
// Chance that noise alone passes for an impact, for each place that is tested.
constexpr double kImpactChance = 1e-6;

// A blow is spread over the filter's reach, which is half a cycle at the end of the band then.
constexpr double kSamplesPerCycle = 8;

/// Mean of y exp(-i w j), twice, over any samples: a running sum.
class RunningAmplitude {
 public:
  RunningAmplitude(const Ref<const VectorXd>& y, double w) : sums_(y.size() + 1) {
    const ArrayXcd z = powers(Complex(0, -w), y.size());
    sums_(0) = 0;
    for (Index j = 0; j < y.size(); ++j) sums_(j + 1) = sums_(j) + y(j) * z(j);
  }
  /// Complex amplitude over samples [from, to); those outside of the record count as zero.
  [[nodiscard]] Complex over(Index from, Index to) const {
    const Index last = sums_.size() - 1;
    const auto length = static_cast<double>(std::max<Index>(1, to - from));
    from = std::clamp<Index>(from, 0, last), to = std::clamp<Index>(to, 0, last);
    return to > from ? 2.0 * (sums_(to) - sums_(from)) / length : 0;
  }
  /// The largest over `length` samples that begin a quarter of it apart.
  [[nodiscard]] double largest(Index length) const {
    double largest = 0;
    for (Index j = 0; j + length < sums_.size(); j += std::max<Index>(1, length / 4)) {
      largest = std::max(largest, std::abs(over(j, j + length)));
    }
    return largest;
  }

 private:
  VectorXcd sums_;
};

/// Samples over which an amplitude is averaged: a cycle, and near half the sample rate, where the
/// negative frequency comes close, a cycle of the beat with it.
Index averaging_cycle(double w) {
  const double f = w / kTwoPi;
  return static_cast<Index>(std::ceil(std::max({4.0, 1 / f, 1 / std::max(1 - 2 * f, 1e-6)})));
}

struct Jump {
  Index at = 0;
  double size = 0;
  double w = 0;  // rad per sample, mode that jumps
};

// Local maxima of |J| that stand out of what the record shows elsewhere, over 2 and over 6 cycles.
std::vector<Jump> jumps(const VectorXd& y, double w) {
  const Index n = y.size(), cycle = averaging_cycle(w);
  const RunningAmplitude running(y, w);
  const Index step = std::max<Index>(1, cycle / 8);
  const double largest = running.largest(cycle);
  std::vector<Jump> found;
  for (const Index cycles : {2, 6}) {
    const Index length = cycles * cycle;
    if (n < 4 * length) break;
    std::vector<double> size, powers;
    for (Index j = 2 * cycle; j + length <= n; j += step) {
      const Complex before =
          1.5 * running.over(j - length, j) - 0.5 * running.over(j - 2 * length, j - length);
      const Complex behind =
          1.5 * running.over(j, j + length) - 0.5 * running.over(j + length, j + 2 * length);
      const double jump = std::abs(behind - before);
      size.push_back(jump > 0.1 * std::abs(before) ? jump : 0);
      powers.push_back(jump * jump);
    }
    if (powers.empty()) break;
    // |J|^2 of noise is exponential: its median is ln 2 of its mean.
    const double places = static_cast<double>(n) / static_cast<double>(length);
    const double noise = std::sqrt(median(powers) / std::numbers::ln2 * std::log(1 + 1e3 * places));
    const double least = std::max(kLeastShare * largest, noise);
    const auto reach = static_cast<std::ptrdiff_t>(2 * cycle / step);
    for (auto k = size.begin(); k != size.end(); ++k) {
      if (*k < least) continue;
      const auto from = k - std::min<std::ptrdiff_t>(reach, k - size.begin());
      const auto to = k + std::min<std::ptrdiff_t>(reach + 1, size.end() - k);
      if (std::max_element(from, to) != k) continue;
      found.push_back({2 * cycle + static_cast<Index>(k - size.begin()) * step, *k, w});
    }
  }
  return found;
}

// The damped sinusoids of `values`, NaN where missing; nothing where hardly any are there.
std::optional<DampedSinusoidsFit> fitted(const VectorXd& values) {
  const DecaySamples samples = decay_samples(values, 0, values.size());
  auto fit = find_decay_modes(samples, {0, 0.5, true}, {}, kModes);
  return fit ? fit : fit_poles(samples, {});
}

// Complex amplitude of what a fit has within a tenth of w, at sample `at` of it: several modes
// there may be what one that changes looks like.
Complex amplitude_near(const DampedSinusoidsFit& fit, double w, Index at) {
  Complex sum = 0;
  for (std::size_t m = 0; m < fit.poles.size(); ++m) {
    if (std::abs(fit.poles[m].imag() - w) > 0.1 * w) continue;
    sum += fit.amplitudes[m] * std::exp(fit.poles[m] * static_cast<double>(at));
  }
  return sum;
}

// Whether two decays, the second behind the jump, explain the samples of [from, to) better than
// one. `x`: y without its trend.
bool is_impact(const Ref<const VectorXd>& y, const VectorXd& x, const Jump& place, Index from,
               Index to, Index half_cycle, double largest) {
  const Index at = place.at;
  const Index gap_from = at - half_cycle, gap_to = at + half_cycle;
  if (gap_from - from < 4 * half_cycle || to - gap_to < 4 * half_cycle) return false;
  if (gap_from - from < 24 || to - gap_to < 24) return false;
  VectorXd both = y.segment(from, to - from);
  both.segment(gap_from - from, gap_to - gap_from).setConstant(kNaN);
  const auto before = fitted(y.segment(from, gap_from - from)), one = fitted(both),
             behind = fitted(y.segment(gap_to, to - gap_to));
  // An impact sets something off.
  if (!before || !one || !behind || behind->poles.empty()) return false;
  // Beats of many modes look like blows, and one fit lacks some of them: a blow doubles the motion.
  const auto many = [](const auto& fit) { return std::ssize(fit->poles) > kModes / 2; };
  const auto power = [&](Index first, Index last) {
    return x.segment(first, last - first).squaredNorm() / static_cast<double>(last - first);
  };
  // With twice the power 3 of 60 single taps of twelve modes were cut, with four times 2; with
  // eight second taps of the first's strength are lost.
  const bool doubles = power(gap_to, to) > 4 * power(from, gap_from);
  if ((many(before) || many(behind)) && !doubles) return false;
  const double apart = before->residual_sum_squares + behind->residual_sum_squares;
  const auto degrees = static_cast<double>(before->degrees + behind->degrees);
  const double more = std::max(2.0, static_cast<double>(one->degrees) - degrees);
  if (degrees < 4) return false;
  const double ratio =
      (one->residual_sum_squares - apart) / more / std::max(apart / degrees, 1e-300);
  if (!(ratio > 0) || gsl_cdf_fdist_Q(ratio, more, degrees) > kImpactChance) return false;
  const Complex now = amplitude_near(*behind, place.w, -half_cycle);
  const Complex then = amplitude_near(*before, place.w, at - from);
  if (now == 0.0) return false;
  // What friction takes leaves the phase as it is.
  const Complex kept = then == 0.0 ? 1.0 : now / then;
  const double lost = std::clamp(kept.real(), 0.0, 1.0);
  const double jump = std::norm(now - lost * then);
  // The end of a line through n amplitudes has 4 times the variance of their mean, 4 s^2 / n.
  double variance = 0;
  for (const auto* side : {&*before, &*behind}) {
    variance += 16 / static_cast<double>(side->samples) *
                residual_noise(side->residual, side->degrees).white_equivalent(place.w / kTwoPi);
  }
  return jump > std::pow(kLeastShare * largest, 2) && jump > -std::log(kImpactChance) * variance;
}

/// Samples at which impacts start, in time: `hits`, which are known, and further ones. `y`: NaN
/// where missing; `w`: of the modes looked at, rad per sample, first the one that tells `hits`.
std::vector<Index> with_further(std::vector<Index> hits, const Ref<const VectorXd>& y,
                                const std::vector<double>& w) {
  const Index n = y.size(), cycle = averaging_cycle(w.front());
  if (n < 8 * cycle) return hits;
  const VectorXd x = without_trend(y);
  // The largest of each mode first: what stands beside an impact already found, and every place
  // close to it, is its own skirt; modes that are told worse place it worse.
  std::vector<Jump> found;
  for (const double each : w) {
    auto own = jumps(x, each);
    std::ranges::sort(own, std::greater(), &Jump::size);
    found.insert(found.end(), own.begin(), own.end());
  }
  const double largest = RunningAmplitude(x, w.front()).largest(cycle);
  std::vector<Index> tested = hits;
  const Index half_cycle = (cycle + 1) / 2;
  for (const Jump& jump : found) {
    if (std::ranges::any_of(tested, [&](Index t) { return std::abs(t - jump.at) < 3 * cycle; })) {
      continue;
    }
    tested.push_back(jump.at);
    Index from = std::max<Index>(0, jump.at - kCycles * cycle);
    Index to = std::min(n, jump.at + kCycles * cycle);
    for (const Index hit : hits) {
      if (hit < jump.at) from = std::max(from, hit + half_cycle);
      if (hit > jump.at) to = std::min(to, hit - half_cycle);
    }
    if (is_impact(y, x, jump, from, to, half_cycle, largest)) hits.push_back(jump.at);
  }
  std::ranges::sort(hits);
  return hits;
}

struct Onset {
  Index start = 0;
  double energy = 0;      // taken out from there on
  double from_first = 0;  // the most that any decay from sample 0 takes out
};

// Best start for a sinusoid of frequency w over a bank of decay rates.
Onset best_onset(const VectorXd& y, double w) {
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
bool quiet_before(const VectorXd& y, double w, Index start, Index cycle) {
  // Less the line between half a cycle before and behind: a sway is straight for so long.
  const Index half = cycle / 2, n = y.size() - 2 * half;
  const RunningAmplitude running(y.segment(half, n) - 0.5 * (y.head(n) + y.tail(n)), w);
  start = std::max<Index>(0, start - half);
  const double after = std::abs(running.over(start, start + cycle));
  const Index until = start < 4 * cycle ? start : start - cycle;
  for (Index j = 0; j + cycle <= until; j += cycle / 2) {
    if (std::abs(running.over(j, j + cycle)) > 0.3 * after) return false;
  }
  return true;
}

}  // namespace

Index recorded_until(const Ref<const VectorXd>& y) {
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

std::vector<DecayWindow> find_decays(const Ref<const VectorXd>& samples, const DecayBand& band) {
  const Index n = recorded_until(samples);
  const auto y = samples.head(n);
  const VectorXd x = without_trend(y);
  if (n < 16 || !(x.squaredNorm() > 0)) return {{0, n}};
  auto candidates = search_decays(x, {.lowest = band.low, .highest = band.high, .candidates = 64});
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
    const double each = c.pole.imag();
    const bool weak = c.energy < 0.05 * candidates.front().energy;
    if (!weak) strong.push_back(each);
    const Onset best = best_onset(x, each);
    const double now = best.energy - best.from_first;
    const Index cycle = averaging_cycle(each);
    const bool late = now > detection_threshold(n, 1e-6) * c.noise_variance &&
                      now > 0.1 * best.energy && best.start > cycle && n - best.start > 3 * cycle;
    const std::pair found(late && quiet_before(x, each, best.start, cycle), now);
    // Beside what is stronger, a tap: sway or hum goes on behind it, an earlier decay has gone.
    if (weak && !(found.first && 2 * x.head(best.start).squaredNorm() < x.squaredNorm())) continue;
    if (found > std::pair(quiet, gain)) std::tie(quiet, gain) = found, onset = best.start, w = each;
  }
  const Index cycle = averaging_cycle(w);
  std::erase(strong, w);
  strong.insert(strong.begin(), w);
  std::vector<Index> starts = with_further(std::vector<Index>(quiet ? 1 : 0, onset), y, strong);
  // A record that was cut off at a rail and comes off it steps its amplitude too.
  const double high = y.maxCoeff<Eigen::PropagateNumbers>();
  const double low = y.minCoeff<Eigen::PropagateNumbers>();
  std::erase_if(starts, [&](Index start) {
    if (quiet && start == onset) return false;
    const Index reach = std::min(start, 8 * cycle);
    const auto before = y.segment(start - reach, reach).array();
    return (before == high).count() > 1 || (before == low).count() > 1;
  });
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
