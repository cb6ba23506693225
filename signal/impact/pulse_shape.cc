#include "signal/impact/pulse_shape.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "signal/estimation/robust.h"

namespace rigfit::signal {
using Eigen::Index;
using Eigen::VectorXd;

PulseShape pulse_shape(const VectorXd& samples, Index first, Index length) {
  constexpr double kEdge = 0.1;  // a pulse ends below this part of its peak
  first = std::clamp<Index>(first, 0, samples.size());
  length = std::min(length, samples.size() - first);
  constexpr PulseShape kUnclear{0.4, 0.25};  // neither
  if (length < 8) return kUnclear;
  const Index quiet = std::max<Index>(4, length / 40);
  const auto level = [&](const VectorXd& part) {
    std::vector<double> values;
    for (const double v : part) {
      if (std::isfinite(v)) values.push_back(v);
    }
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
  if (!(height > 6 * noise)) return kUnclear;
  const double sign = x[peak] > 0 ? 1 : -1;
  Index pulse_first = peak, pulse_last = peak;
  while (pulse_first > 0 && sign * x[pulse_first - 1] > kEdge * height) --pulse_first;
  while (pulse_last + 1 < length && sign * x[pulse_last + 1] > kEdge * height) ++pulse_last;
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

}  // namespace rigfit::signal
