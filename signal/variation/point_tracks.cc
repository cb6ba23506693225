#include "signal/variation/point_tracks.h"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "signal/numerics/numbers.h"

namespace rigfit::signal {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::VectorXd;

/// Widest drift between points: of both, half-power bandwidths, and relative.
constexpr double kDriftBandwidths = 20, kDriftRelative = 0.02;

/// Distance when two poles may be one mode, negative when not.
double link_distance(const ModalBand& band, const PointPole& a, const PointPole& b) {
  const double ha = band.window - a.pole.real(), hb = band.window - b.pole.real();
  const double apart = std::abs(a.pole - b.pole) / (ha + hb + 0.5 * kTwoPi * band.spacing_hz);
  if (apart < 1) return apart;
  const bool clear = a.explained > 0.8 && b.explained > 0.8;
  const bool alike = std::max(ha, hb) < 2.5 * std::min(ha, hb);
  const double away = std::abs(a.pole.imag() - b.pole.imag());
  const bool within = away < kDriftBandwidths * (ha + hb) &&
                      away < kDriftRelative * std::min(a.pole.imag(), b.pole.imag());
  return clear && alike && within ? apart : -1;
}

/// Weighted straight line (or mean) under weights 1 / (std^2 + tau^2).
struct Line {
  double mean = 0, slope = 0;          ///< at the middle of all points; per point
  double mean_std = 0, slope_std = 0;  ///< from the weighted scatter, no t yet
  double chi2 = 0;
};

Line fit_line(const ArrayXd& y, const ArrayXd& std, const ArrayXd& x, double tau2, bool sloped) {
  const ArrayXd w = (std.square() + tau2).inverse();
  const double sw = w.sum(), swx = (w * x).sum(), swxx = (w * x.square()).sum();
  const double swy = (w * y).sum(), swxy = (w * x * y).sum();
  Line line;
  if (!sloped) {
    line.mean = swy / sw;
    line.chi2 = (w * (y - line.mean).square()).sum();
    line.mean_std = std::sqrt(1 / sw);
    return line;
  }
  const double det = sw * swxx - swx * swx;
  line.mean = (swxx * swy - swx * swxy) / det;
  line.slope = (sw * swxy - swx * swy) / det;
  line.chi2 = (w * (y - line.mean - line.slope * x).square()).sum();
  line.mean_std = std::sqrt(swxx / det);
  line.slope_std = std::sqrt(sw / det);
  return line;
}

/// tau^2 that makes chi2 its expectation; 0 when the points agree.
double paule_mandel(const ArrayXd& y, const ArrayXd& std, const ArrayXd& x, bool sloped) {
  const double freedom = static_cast<double>(y.size()) - (sloped ? 2 : 1);
  if (fit_line(y, std, x, 0, sloped).chi2 <= freedom) return 0;
  double low = 0, high = (y - y.mean()).square().sum() + std.square().maxCoeff();
  while (fit_line(y, std, x, high, sloped).chi2 > freedom) high *= 4;
  for (int i = 0; i < 200 && high - low > 1e-9 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (fit_line(y, std, x, middle, sloped).chi2 > freedom ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Factor by which a standard deviation grows so that +-1.96 of it hold 95 %.
double widening(double freedom) { return gsl_cdf_tdist_Pinv(0.975, freedom) / 1.959964; }

}  // namespace

std::vector<std::vector<PointPole>> link_points(const ModalBand& band,
                                                std::vector<PointPole> poles) {
  std::sort(poles.begin(), poles.end(),
            [](const auto& a, const auto& b) { return a.pole.imag() < b.pole.imag(); });
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < poles.size(); ++i) {
    for (std::size_t j = i + 1; j < poles.size(); ++j) {
      // Broad poles reach furthest; beyond a fifth of the frequency nothing is one mode.
      if (poles[j].pole.imag() > 1.5 * poles[i].pole.imag()) break;
      if (poles[i].point == poles[j].point) continue;
      const double distance = link_distance(band, poles[i], poles[j]);
      if (distance >= 0) pairs.emplace_back(distance, i, j);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<std::size_t> owner(poles.size());
  std::iota(owner.begin(), owner.end(), std::size_t{0});
  std::vector<std::vector<std::size_t>> members(poles.size());
  for (std::size_t i = 0; i < poles.size(); ++i) members[i] = {i};
  for (const auto& [distance, i, j] : pairs) {
    const std::size_t a = owner[i], b = owner[j];
    if (a == b) continue;
    const bool shared = std::any_of(members[a].begin(), members[a].end(), [&](std::size_t m) {
      return std::any_of(members[b].begin(), members[b].end(),
                         [&](std::size_t n) { return poles[m].point == poles[n].point; });
    });
    if (shared) continue;
    for (const std::size_t n : members[b]) owner[n] = a;
    members[a].insert(members[a].end(), members[b].begin(), members[b].end());
    members[b].clear();
  }
  std::vector<std::vector<PointPole>> tracks;
  for (const auto& group : members) {
    if (group.empty()) continue;
    std::vector<PointPole> track;
    for (const std::size_t m : group) track.push_back(poles[m]);
    std::sort(track.begin(), track.end(),
              [](const auto& a, const auto& b) { return a.point < b.point; });
    tracks.push_back(std::move(track));
  }
  return tracks;
}

LineOverPoints line_over_points(const Eigen::Ref<const VectorXd>& value,
                                const Eigen::Ref<const VectorXd>& std,
                                const Eigen::Ref<const VectorXd>& x) {
  const ArrayXd y = value.array(), at = x.array();
  const ArrayXd s = std.array().max(1e-12 * value.cwiseAbs().maxCoeff());
  const double tau2 = paule_mandel(y, s, at, true), freedom = static_cast<double>(y.size()) - 2;
  const Line line = fit_line(y, s, at, tau2, true);
  const double scale = std::sqrt(std::max(1.0, line.chi2 / freedom));
  LineOverPoints result;
  result.slope = {line.slope, line.slope_std * scale};
  result.level = {line.mean, line.mean_std * scale * widening(freedom)};
  const double t = std::abs(line.slope) / std::max(result.slope.std, 1e-300);
  result.chance = 2 * gsl_cdf_tdist_Q(t, freedom);
  return result;
}

MeanOverPoints mean_over_points(const Eigen::Ref<const VectorXd>& value,
                                const Eigen::Ref<const VectorXd>& std,
                                const Eigen::Ref<const VectorXd>& order, Index points) {
  MeanOverPoints result;
  const Index n = value.size();
  if (n == 0) return result;
  if (n == 1) {
    result.value = {value[0], std[0]};
    return result;
  }
  const ArrayXd y = value.array(), s = std.array().max(1e-12 * value.cwiseAbs().maxCoeff());
  const ArrayXd x = order.array() - 0.5 * static_cast<double>(points - 1);
  const double tau2 = paule_mandel(y, s, x, false);
  result.between_std = std::sqrt(tau2);
  const Line alone = fit_line(y, s, x, 0, false);
  result.excess_chance = gsl_cdf_chisq_Q(alone.chi2, static_cast<double>(n - 1));
  const Line flat = fit_line(y, s, x, tau2, false);
  // Hartung and Knapp's factor, never below the errors of the points themselves.
  const double freedom = static_cast<double>(n - 1);
  result.value = {
      flat.mean, flat.mean_std * std::sqrt(std::max(1.0, flat.chi2 / freedom)) * widening(freedom)};
  if (n < 4) return result;
  const LineOverPoints line = line_over_points(value, std, x.matrix());
  result.trend = line.slope;
  result.has_trend = line.chance < 0.01;
  if (result.has_trend) result.value = line.level;
  return result;
}

}  // namespace rigfit::signal
