#include "signal/decay/decay_window.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "signal/numerics/numbers.h"
#include "signal/recording/clipping.h"
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

// Samples over which an amplitude is averaged: a cycle, and near half the sample rate, where the
// negative frequency comes close, a cycle of the beat with it.
Index averaging_cycle(double w) {
  const double f = w / kTwoPi;
  return static_cast<Index>(std::ceil(std::max({4.0, 1 / f, 1 / std::max(1 - 2 * f, 1e-6)})));
}

// Complex amplitude over a cycle, from running sums of y exp(-i w j).
class RunningAmplitude {
 public:
  RunningAmplitude(const Eigen::VectorXd& y, double w) : sums_(y.size() + 1) {
    Complex sum = 0, z = 1;
    const Complex q = std::polar(1.0, -w);
    sums_(0) = 0;
    for (Index j = 0; j < y.size(); ++j) {
      if (j % 1024 == 0) z = std::polar(1.0, -w * static_cast<double>(j));
      sum += y(j) * z;
      sums_(j + 1) = sum;
      z *= q;
    }
  }
  Complex over(Index from, Index to) const {
    from = std::max<Index>(from, 0), to = std::min<Index>(to, sums_.size() - 1);
    return to > from ? 2.0 * (sums_(to) - sums_(from)) / static_cast<double>(to - from) : 0;
  }

 private:
  Eigen::VectorXcd sums_;
};

// Energy that exp(-a j) of frequency w takes out of the samples.
double decay_energy(const Eigen::Ref<const Eigen::VectorXd>& y, double w, double a) {
  const Complex q = std::exp(Complex(-a, -w));
  const double q2 = std::exp(-2 * a);
  Complex sum = 0;
  double energy = 0;
  for (Index s = y.size() - 1; s >= 0; --s) {
    const double re = sum.real() * q.real() - sum.imag() * q.imag() + y(s);
    sum = Complex(re, sum.real() * q.imag() + sum.imag() * q.real());
    energy = 1 + q2 * energy;
  }
  return 2 * std::norm(sum) / energy;
}

struct BestDecay {
  double energy = 0, rate = 0;
};

// The decay from the first sample on that takes out most. Rates 1.4 apart: the nearest takes out
// all but 0.7 % of what the right one does.
BestDecay best_decay(const Eigen::Ref<const Eigen::VectorXd>& y, double w) {
  BestDecay best;
  const auto n = static_cast<double>(y.size());
  for (double decays = 0.25; decays / n < 0.2 * w; decays *= 1.4) {
    const double energy = decay_energy(y, w, decays / n);
    if (energy > best.energy) best = {energy, decays / n};
  }
  return best;
}

// Whether two decays, the second from `at` on, explain the samples better than one by more than
// noise as large as what they leave would. The one may have its best frequency: a second decay with
// a phase of its own would make up for a wrong one.
bool two_decays(const Eigen::Ref<const Eigen::VectorXd>& y, Index at, double w) {
  const Index n = y.size();
  const double both = best_decay(y.head(at), w).energy + best_decay(y.tail(n - at), w).energy;
  BestDecay one = best_decay(y, w);
  const double width = kTwoPi / static_cast<double>(n) + one.rate;
  double low = w - width, high = w + width;
  constexpr double kGolden = 0.6180339887498949;
  double left_w = high - kGolden * width * 2, right_w = low + kGolden * width * 2;
  double left = decay_energy(y, left_w, one.rate), right = decay_energy(y, right_w, one.rate);
  for (int step = 0; step < 12; ++step) {  // to 1/160 of the width
    if (left > right) {
      high = right_w, right_w = left_w, right = left;
      left_w = high - kGolden * (high - low), left = decay_energy(y, left_w, one.rate);
    } else {
      low = left_w, left_w = right_w, left = right;
      right_w = low + kGolden * (high - low), right = decay_energy(y, right_w, one.rate);
    }
  }
  one.energy = std::max(one.energy, best_decay(y, 0.5 * (low + high)).energy);
  const double rest = std::max(0.0, y.squaredNorm() - both);
  // Two complex amplitudes and two rates.
  const auto degrees = static_cast<double>(std::max<Index>(1, n - 6));
  return both - one.energy > detection_threshold(n, 1e-6) * rest / degrees;
}

struct Jump {
  Index at = 0;
  double rise = 0, after = 0;  // amplitudes
};

// Jumps that are clear within a cycle: noise of that variance reaches the amplitude with a chance
// of 1e-6 in the whole record (|A|^2 is exponential with mean 4 s^2 / cycle). Of the others, which
// in noise grow in number with the record, the largest few.
std::vector<Jump> worth_testing(std::vector<Jump> jumps, Index samples, Index cycle,
                                double noise_variance) {
  constexpr std::size_t kUnclear = 4;
  const double clear = 4 * noise_variance / static_cast<double>(cycle) *
                       std::log(static_cast<double>(samples) / 1e-6);
  const auto unclear = std::stable_partition(
      jumps.begin(), jumps.end(), [&](const Jump& j) { return j.after * j.after > clear; });
  std::sort(unclear, jumps.end(), [](const Jump& a, const Jump& b) { return a.rise > b.rise; });
  if (static_cast<std::size_t>(jumps.end() - unclear) > kUnclear) {
    jumps.erase(unclear + kUnclear, jumps.end());
  }
  std::sort(jumps.begin(), jumps.end(), [](const Jump& a, const Jump& b) { return a.at < b.at; });
  return jumps;
}

// Onsets of further impacts: within a cycle the amplitude comes from under a third of what it then
// is, what it then is is a good part of the record's largest, and noise alone would not look so. (A
// beat needs a beat period under five cycles to rise so fast.)
std::vector<Index> impacts(const Eigen::VectorXd& y, double w, Index cycle,
                           const Eigen::VectorXi& missing_before, double noise_variance) {
  std::vector<Jump> found;
  if (y.size() < 8 * cycle) return {};
  const RunningAmplitude running(y, w);
  const Index step = std::max<Index>(1, cycle / 8);
  double largest = 0;
  for (Index j = 0; j + cycle <= y.size(); j += step) {
    largest = std::max(largest, std::abs(running.over(j, j + cycle)));
  }
  Jump best{-1};
  for (Index j = 0; j + cycle <= y.size(); j += step) {
    const double before = j >= cycle ? std::abs(running.over(j - cycle, j)) : 0;
    const double after = std::abs(running.over(j, j + cycle));
    const bool gap =
        j >= cycle && missing_before(j + cycle) > missing_before(j - cycle);  // no impact, a gap
    const bool jump = j >= cycle && !gap && after > 3 * before && after > 0.3 * largest;
    if (jump && after - before > best.rise) best = {j, after - before, after};
    if (best.at >= 0 && (j > best.at + 2 * cycle || j + cycle + step > y.size())) {
      found.push_back(best);
      best = {-1};
    }
  }
  found = worth_testing(std::move(found), y.size(), cycle, noise_variance);
  // In a weak signal noise jumps as far: each impact has to be worth a decay of its own.
  std::vector<Index> believed;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Index from = believed.empty() ? 0 : believed.back();
    const Index to = k + 1 < found.size() ? found[k + 1].at : y.size();
    if (two_decays(y.segment(from, to - from), found[k].at - from, w)) {
      believed.push_back(found[k].at);
    }
  }
  return believed;
}

// Whether what lies before an onset is small beside what follows: a beat that swells is not.
bool quiet_before(const Eigen::VectorXd& y, double w, Index start, Index cycle) {
  const RunningAmplitude running(y, w);
  const double after = std::abs(running.over(start, start + cycle));
  for (Index j = 0; j + cycle <= start; j += std::max<Index>(1, cycle / 2)) {
    if (std::abs(running.over(j, j + cycle)) > 0.3 * after) return false;
  }
  return true;
}

}  // namespace

Index clipped_until(const Eigen::Ref<const Eigen::VectorXd>& y, double cycles_per_sample) {
  double high = -std::numeric_limits<double>::infinity(), low = -high;
  for (Index j = 0; j < y.size(); ++j) {
    if (std::isfinite(y(j))) high = std::max(high, y(j)), low = std::min(low, y(j));
  }
  const double amplitude = 0.5 * (high - low);
  if (!(amplitude > 0)) return 0;
  // Quantum: the least step between neighbouring samples that is a step at all.
  double quantum = std::numeric_limits<double>::infinity();
  for (Index j = 1; j < y.size(); ++j) {
    const double step = std::abs(y(j) - y(j - 1));
    if (step > 1e-9 * amplitude) quantum = std::min(quantum, step);
  }
  quantum = std::min(quantum, amplitude);
  // A sinusoid stays within one quantum of its peak for acos(1 - q/A) / (pi f) samples.
  const double natural =
      std::acos(1 - quantum / amplitude) / (std::numbers::pi * cycles_per_sample);
  const double longest = std::max(3.0, 2 * natural + 2);
  Index last = 0;
  for (const double rail : {high, low}) {
    Index run = 0, any = 0;
    bool flat = false;
    for (Index j = 0; j <= y.size(); ++j) {
      if (j < y.size() && std::abs(y(j) - rail) <= 1e-12 * amplitude) {
        ++run, any = j + 1;
        continue;
      }
      flat = flat || static_cast<double>(run) >= longest;
      run = 0;
    }
    if (flat || piles_up(y, rail)) last = std::max(last, any);
  }
  return last;
}

std::vector<DecayWindow> find_decays(const Eigen::Ref<const Eigen::VectorXd>& y,
                                     std::vector<DecayCandidate>* peaks) {
  const Index n = y.size();
  DecayWindow whole;
  whole.end = n;
  const Eigen::VectorXd x = without_trend(y);
  const double total = x.squaredNorm();
  Eigen::VectorXi missing_before(n + 1);  // missing samples before each
  missing_before(0) = 0;
  for (Index j = 0; j < n; ++j) missing_before(j + 1) = missing_before(j) + !std::isfinite(y(j));
  if (n < 16 || !(total > 0)) return {whole};

  DecaySearchOptions search;
  search.candidates = 4;
  auto all = decay_peaks(x);
  const auto candidates = distinct_decays(all, n, search);
  if (peaks != nullptr) *peaks = std::move(all);
  if (candidates.empty()) return {whole};

  // The candidate that gains most by starting later tells where the event is; hum gains nothing.
  Onset chosen;
  double gain = 0, noise = candidates.front().noise_variance;
  double w = candidates.front().pole.imag();
  for (const auto& c : candidates) {
    if (c.energy < 0.05 * candidates.front().energy) break;
    const Onset onset = best_onset(x, c.pole.imag());
    const double now = onset.energy - onset.from_first;
    if (now > gain) gain = now, chosen = onset, noise = c.noise_variance, w = c.pole.imag();
  }
  const Index cycle = averaging_cycle(w);
  const bool late = gain > detection_threshold(n, 1e-6) * noise && gain > 0.1 * chosen.energy &&
                    chosen.start > cycle && n - chosen.start > 3 * cycle &&
                    quiet_before(x, w, chosen.start, cycle);

  std::vector<Index> starts;
  starts = impacts(x, w, cycle, missing_before, noise);
  std::vector<DecayWindow> windows;
  const auto add = [&](Index from, Index to, bool impact) {
    DecayWindow window;
    // An impact lasts: half a cycle is left to it (more where the fit then shows so).
    if (impact) from = std::min(from + static_cast<Index>(std::ceil(0.5 * kTwoPi / w)), to - 1);
    window.start = from, window.end = to, window.after_impact = impact;
    const Index clip = clipped_until(y.segment(from, to - from), w / kTwoPi);
    if (clip > 0) {
      window.clipped_until = from + clip;
      window.start = std::min(from + clip, to);
    }
    windows.push_back(window);
  };
  if (starts.size() >= 2 || (starts.size() == 1 && !late && starts.front() > 4 * cycle)) {
    // Each stretch between impacts is a decay of its own; its onset is sharpened within it.
    if (!late && starts.front() > 4 * cycle) starts.insert(starts.begin(), 0);
    for (std::size_t k = 0; k < starts.size(); ++k) {
      const Index from = std::max<Index>(0, starts[k] - 2 * cycle * (starts[k] > 0));
      const Index to =
          k + 1 < starts.size() ? std::max<Index>(starts[k + 1] - 2 * cycle, from + 1) : n;
      const Onset onset = best_onset(x.segment(from, to - from), w);
      add(starts[k] > 0 ? from + onset.start : 0, to, starts[k] > 0);
    }
  } else {
    add(late ? chosen.start : 0, n, late);
  }
  return windows;
}

}  // namespace rigfit::signal
