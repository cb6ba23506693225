#include "signal/variation/amplitude_trend.h"

#include <gsl/gsl_cdf.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>

#include "signal/variation/point_tracks.h"

namespace rigfit::signal {
namespace {
using Eigen::Index;
using Eigen::VectorXd;

constexpr std::size_t kFewestPoints = 5;
/// Amplitudes that differ by less than this part of the strongest's square tell nothing.
constexpr double kLeastSpread = 1e-3;

double t_over_normal(double freedom) { return gsl_cdf_tdist_Pinv(0.975, freedom) / 1.959964; }

/// Over points hit once each.
std::optional<AmplitudeTrend> trend_over_points(const std::vector<ValueOfHit>& fits) {
  const auto n = static_cast<Index>(fits.size());
  VectorXd x(n), y(n), std(n);
  for (Index i = 0; i < n; ++i) {
    const ValueOfHit& fit = fits[static_cast<std::size_t>(i)];
    x[i] = fit.amplitude * fit.amplitude;
    y[i] = fit.value.value;
    std[i] = fit.value.std;
  }
  const double strongest = x.maxCoeff();
  if (!(x.maxCoeff() - x.minCoeff() > kLeastSpread * strongest) || !(std.minCoeff() > 0)) return {};
  const LineOverPoints line = line_over_points(y, std, x / strongest);
  AmplitudeTrend trend;
  trend.chance = line.chance;
  trend.small = line.level;
  trend.slope = {line.slope.value / strongest, line.slope.std / strongest};
  trend.strongest = line.level.value + line.slope.value;
  return trend;
}

/// Sums over the hits of one point.
struct PointSums {
  double count = 0, x = 0, y = 0;
};

/// Over the hits of each point, one slope for all.
std::optional<AmplitudeTrend> trend_over_hits(const std::vector<ValueOfHit>& fits) {
  std::map<std::size_t, PointSums> points;
  double strongest = 0, noise = 0;
  for (const ValueOfHit& fit : fits) {
    PointSums& point = points[fit.point];
    ++point.count;
    point.x += fit.amplitude * fit.amplitude;
    point.y += fit.value.value;
    strongest = std::max(strongest, fit.amplitude * fit.amplitude);
    noise += fit.value.std * fit.value.std;
  }
  const auto n = static_cast<double>(fits.size()), groups = static_cast<double>(points.size());
  const double freedom = n - groups - 1;
  if (freedom < 1) return {};
  double xx = 0, xy = 0, yy = 0;
  for (const ValueOfHit& fit : fits) {
    const PointSums& point = points[fit.point];
    const double x = fit.amplitude * fit.amplitude - point.x / point.count;
    const double y = fit.value.value - point.y / point.count;
    xx += x * x, xy += x * y, yy += y * y;
  }
  if (!(xx > kLeastSpread * kLeastSpread * strongest * strongest * n)) return {};
  const double slope = xy / xx;
  const double variance = std::max(std::max(0.0, yy - slope * xy) / freedom, noise / n);
  if (!(variance > 0)) return {};
  const double slope_std = std::sqrt(variance / xx);
  double level = 0, x_mean = 0;
  for (const auto& [name, point] : points) {
    level += (point.y - slope * point.x) / n;
    x_mean += point.x / n;
  }
  double between = 0;
  for (const auto& [name, point] : points) {
    between += std::pow((point.y - slope * point.x) / point.count - level, 2);
  }
  // Points that differ by themselves are a sample of so many.
  const double of_hits = variance / n;
  const double of_points = groups > 1 ? between / (groups - 1) / groups : 0;
  const bool differ = of_points > of_hits;
  const double level_part =
      std::max(of_hits, of_points) * std::pow(t_over_normal(differ ? groups - 1 : freedom), 2);
  const double slope_part = std::pow(slope_std * x_mean * t_over_normal(freedom), 2);
  AmplitudeTrend trend;
  trend.chance = 2 * gsl_cdf_tdist_Q(std::abs(slope) / slope_std, freedom);
  trend.small = {level, std::sqrt(level_part + slope_part)};
  trend.slope = {slope, slope_std * t_over_normal(freedom)};
  trend.strongest = level + slope * strongest;
  return trend;
}

}  // namespace

std::optional<AmplitudeTrend> amplitude_trend(const std::vector<ValueOfHit>& fits) {
  std::map<std::size_t, int> points;
  for (const ValueOfHit& fit : fits) ++points[fit.point];
  if (fits.size() > points.size()) return trend_over_hits(fits);
  return fits.size() < kFewestPoints ? std::nullopt : trend_over_points(fits);
}

}  // namespace rigfit::signal
