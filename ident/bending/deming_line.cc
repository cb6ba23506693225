#include "ident/bending/deming_line.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "signal/estimation/robust.h"

namespace rigfit::ident {
namespace {

struct Moments {
  double weight = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;  // xx .. about the means
};

Moments moments(const Eigen::ArrayXd& x, const Eigen::ArrayXd& y, const Eigen::ArrayXd& w) {
  Moments m;
  m.weight = w.sum();
  m.x = (w * x).sum() / m.weight;
  m.y = (w * y).sum() / m.weight;
  m.xx = (w * (x - m.x).square()).sum();
  m.yy = (w * (y - m.y).square()).sum();
  m.xy = (w * (x - m.x) * (y - m.y)).sum();
  return m;
}

// `ratio`: variance of y's errors over that of x's; infinite for an exact x.
double deming_slope(const Moments& m, double ratio) {
  if (!std::isfinite(ratio)) return m.xy / m.xx;
  const double difference = m.yy - ratio * m.xx;
  const double root = std::hypot(difference, 2 * std::sqrt(ratio) * m.xy);
  // Two forms of the same root; the one that does not cancel is taken.
  return difference >= 0 ? (difference + root) / (2 * m.xy)
                         : 2 * ratio * m.xy / (root - difference);
}

// Relative change of slope over the range: weighted least squares of a parabola in the scaled x.
double curvature_of(const Eigen::ArrayXd& x, const Eigen::ArrayXd& y, const Eigen::ArrayXd& w) {
  const double low = x.minCoeff(), range = x.maxCoeff() - low;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double u = (x[i] - low) / range - 0.5;
    const Eigen::Vector3d row(1, u, u * u);
    normal.noalias() += w[i] * row * row.transpose();
    right += w[i] * y[i] * row;
  }
  const Eigen::Vector3d parabola = normal.ldlt().solve(right);
  return 2 * parabola[2] / parabola[1];
}

}  // namespace

DemingLine fit_deming_line(const Eigen::Ref<const Eigen::VectorXd>& x_in,
                           const Eigen::Ref<const Eigen::VectorXd>& y_in, double noise_x,
                           double noise_y, bool uncertainty) {
  DemingLine line;
  const Eigen::ArrayXd x = x_in.array(), y = y_in.array();
  const Eigen::Index n = x.size();
  if (n < 4 || y.size() != n) return line;
  const double range_x = x.maxCoeff() - x.minCoeff(), range_y = y.maxCoeff() - y.minCoeff();
  if (!(range_x > 0 && range_y > 0)) return line;
  if (noise_x <= 0 && noise_y <= 0) noise_x = range_x, noise_y = range_y;
  const double ratio =
      noise_x > 0 ? std::pow(noise_y / noise_x, 2) : std::numeric_limits<double>::infinity();

  Eigen::ArrayXd w = Eigen::ArrayXd::Ones(n);
  Moments m = moments(x, y, w);
  for (int iteration = 0; iteration < 50; ++iteration) {
    if (m.xy == 0) return line;
    const double before = line.slope;
    line.slope = deming_slope(m, ratio);
    line.offset = m.y - line.slope * m.x;
    if (std::abs(line.slope - before) <= 1e-12 * std::abs(line.slope)) break;
    const Eigen::ArrayXd residual = (y - line.offset - line.slope * x).abs();
    const double scale =
        1.4826 * signal::median(std::vector<double>(residual.data(), residual.data() + n));
    if (!(scale > 1e-14 * range_y)) break;
    w = (1.345 * scale / residual.max(1.345 * scale));
    m = moments(x, y, w);
  }
  const Eigen::ArrayXd residual = y - line.offset - line.slope * x;
  const double freedom = static_cast<double>(n - 2);
  const double variance = (w * residual.square()).sum() / freedom;
  line.residual_rms = std::sqrt(variance);
  line.curvature = curvature_of(x, y, w);
  line.usable = std::isfinite(line.slope) && std::isfinite(line.curvature);

  if (!uncertainty) return line;
  const double textbook = std::sqrt(variance / m.xx);
  line.slope_std = textbook;
  line.degrees_of_freedom = freedom;
  const Eigen::Index blocks = n >= 40 ? 10 : n;
  double slope_sum = 0, slope_squares = 0, curve_sum = 0, curve_squares = 0;
  int used = 0;
  for (Eigen::Index b = 0; b < blocks; ++b) {
    Eigen::ArrayXd reduced = w;
    const Eigen::Index first = b * n / blocks, last = (b + 1) * n / blocks;
    reduced.segment(first, last - first).setZero();
    const Moments part = moments(x, y, reduced);
    const double slope = deming_slope(part, ratio);
    const double curve = curvature_of(x, y, reduced);
    if (!std::isfinite(slope) || !std::isfinite(curve)) continue;
    slope_sum += slope;
    slope_squares += (slope - line.slope) * (slope - line.slope);
    curve_sum += curve;
    curve_squares += (curve - line.curvature) * (curve - line.curvature);
    ++used;
  }
  if (used >= 4) {
    const double factor = (used - 1.0) / used;
    const double mean = slope_sum / used - line.slope, bend = curve_sum / used - line.curvature;
    const double jackknife =
        std::sqrt(std::max(0.0, factor * (slope_squares - used * mean * mean)));
    line.curvature_std = std::sqrt(std::max(0.0, factor * (curve_squares - used * bend * bend)));
    if (jackknife > textbook) {
      line.slope_std = jackknife;
      line.degrees_of_freedom = used - 1.0;
    }
  }
  return line;
}

}  // namespace rigfit::ident
