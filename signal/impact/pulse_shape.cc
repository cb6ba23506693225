#include "signal/impact/pulse_shape.h"

#include "signal/estimation/robust.h"

namespace rigfit::signal {

PulseShape pulse_shape(const VectorXd& samples, Index first, Index length) {
  first = std::clamp<Index>(first, 0, samples.size());
  length = std::min(length, samples.size() - first);
  if (length < 8) return {};
  const Index quiet = std::max<Index>(4, length / 40);
  const auto level = [&](const VectorXd& part) {
    std::vector<double> values = finite_values(part);
    const double middle = median(values);
    return std::pair(middle, robust_std(std::move(values), middle));
  };
  const auto begin = level(samples.segment(first, quiet));
  const auto end = level(samples.segment(first + length - quiet, quiet));
  const auto [rest, noise] = begin.second < end.second ? begin : end;
  const VectorXd x = samples.segment(first, length).unaryExpr([&, rest = rest](double v) {
    return std::isfinite(v) ? v - rest : 0.0;
  });
  Index peak = 0;
  const double height = x.cwiseAbs().maxCoeff(&peak);
  if (!(height > 6 * noise)) return {};
  const double sign = x[peak] > 0 ? 1 : -1;
  Index pulse_first = peak, pulse_last = peak;
  while (pulse_first > 0 && sign * x[pulse_first - 1] > kPulseEdge * height) --pulse_first;
  while (pulse_last + 1 < length && sign * x[pulse_last + 1] > kPulseEdge * height) ++pulse_last;
  const Index width = pulse_last - pulse_first + 1;
  const Index inner_first = std::max<Index>(0, pulse_first - 5 * width);
  const Index inner_last = std::min(length, pulse_last + 5 * width + 1);
  const auto energy = [&, noise = noise](Index from, Index to) {
    return std::max(0.0, x.segment(from, to - from).squaredNorm() -
                             noise * noise * static_cast<double>(to - from));
  };
  PulseShape shape;
  const double inside = energy(inner_first, inner_last);
  const double outside = energy(0, inner_first) + energy(inner_last, length);
  shape.outside = inside + outside > 0 ? outside / (inside + outside) : 0;
  shape.opposite = std::max(0.0, (-sign * x).maxCoeff() - 3 * noise) / height;
  return shape;
}

namespace {

VectorXd correlate(const Ref<const VectorXd>& force, Index pulse_first, Index peak,
                   Index pulse_last) {
  const Index width = pulse_last - pulse_first + 1, before = peak - pulse_first;
  const VectorXd pulse = force.segment(pulse_first, width) / force[peak];
  const double scale = 1 / pulse.squaredNorm();
  VectorXd y(force.size());
  for (Index k = 0; k < y.size(); ++k) {
    const Index first = std::max<Index>(0, before - k);
    const Index last = std::min(width, force.size() - (k - before));
    y[k] = last > first ? scale * pulse.segment(first, last - first)
                                      .dot(force.segment(k - before + first, last - first))
                        : 0;
  }
  return y;
}

}  // namespace

SecondContact find_second_contact(const Ref<const VectorXd>& force, Index pulse_first, Index peak,
                                  Index pulse_last, double smallest) {
  constexpr double kNoise = 6;      // it exceeds so many standard deviations of the filtered noise
  constexpr double kRinging = 0.5;  // swings to the other side of this part of its height
  SecondContact result;
  const double height = force[peak];
  if (!(height > 0)) return result;
  const Index n = force.size(), width = pulse_last - pulse_first + 1;
  const VectorXd y = correlate(force, pulse_first, peak, pulse_last);

  // The hit itself: a half sine ends 3.5 % of its length beyond its 10 % crossings.
  const Index guard = width + width / 10 + 1;
  const Index hit_first = std::max<Index>(0, peak - guard),
              hit_last = std::min(n - 1, peak + guard);
  std::vector<double> rest;
  rest.reserve(static_cast<std::size_t>(n));
  for (Index k = 0; k < n; ++k) {
    if (k < hit_first || k > hit_last) rest.push_back(y[k]);
  }
  const double level = median(rest);
  const double least = std::max(smallest * height, kNoise * robust_std(rest, level));
  result.smallest_visible = least / height;

  for (Index k = 1; k + 1 < n; ++k) {
    const double rise = y[k] - level;
    if (rise < least || (k >= hit_first && k <= hit_last)) continue;
    if (y[k] <= y[k - 1] || y[k] < y[k + 1]) continue;
    Index left = k, right = k;
    while (left > 0 && y[left] - level > rise / 2) --left;
    while (right + 1 < n && y[right] - level > rise / 2) ++right;
    // Ringing dies away from the hit, so the swing between it and the hit is the larger one.
    const Index reach = 2 * (right - left + 1) + width;
    double lowest = y[k];
    if (k > peak) {
      lowest = y.segment(std::max(peak, k - reach), k - std::max(peak, k - reach)).minCoeff();
    } else {
      lowest = y.segment(k + 1, std::min(peak, k + reach) - k).minCoeff();
    }
    if (level - lowest >= kRinging * rise) continue;
    if (rise / height > result.ratio) {
      result.ratio = rise / height;
      result.delay = k - peak;
    }
  }
  return result;
}

}  // namespace rigfit::signal
