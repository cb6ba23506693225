#include "ident/bending/bending_spikes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "signal/estimation/robust.h"

namespace rigfit::ident {
namespace {

/// Of the middle 80 %.
double central_range(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size() - 1);
  return values[static_cast<std::size_t>(0.9 * n)] - values[static_cast<std::size_t>(0.1 * n)];
}

}  // namespace

std::vector<Eigen::Index> find_spikes(const Eigen::VectorXd& x) {
  std::vector<Eigen::Index> spikes;
  const Eigen::Index n = x.size();
  if (n < 20) return spikes;
  std::vector<double> off(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) {
    double least = std::numeric_limits<double>::infinity();
    if (i >= 2) least = std::min(least, std::abs(x[i] - 2 * x[i - 1] + x[i - 2]));
    if (i + 2 < n) least = std::min(least, std::abs(x[i] - 2 * x[i + 1] + x[i + 2]));
    if (i >= 1 && i + 1 < n) least = std::min(least, std::abs(x[i] - 0.5 * (x[i - 1] + x[i + 1])));
    off[static_cast<std::size_t>(i)] = least;
  }
  const double scale = 1.4826 * signal::median(off);
  const double limit = std::max(12 * scale, 0.05 * central_range({x.begin(), x.end()}));
  for (Eigen::Index i = 0; i < n; ++i) {
    if (off[static_cast<std::size_t>(i)] > limit) spikes.push_back(i);
  }
  return spikes;
}

std::vector<Eigen::Index> find_table_spikes(const Eigen::VectorXd& d, const Eigen::VectorXd& Q) {
  std::vector<Eigen::Index> spikes;
  const Eigen::Index n = d.size();
  if (n < 5) return spikes;
  std::vector<double> slopes;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = i + 1; k < n; ++k) {
      if (d[i] != d[k]) slopes.push_back((Q[k] - Q[i]) / (d[k] - d[i]));
    }
  }
  if (slopes.empty()) return spikes;
  const double slope = signal::median(slopes);
  std::vector<double> rest(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) rest[static_cast<std::size_t>(i)] = Q[i] - slope * d[i];
  const double middle = signal::median(rest);
  std::vector<double> off;
  for (double r : rest) off.push_back(std::abs(r - middle));
  const double limit =
      std::max(10 * 1.4826 * signal::median(off), 0.5 * central_range({Q.begin(), Q.end()}) / 0.8);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (off[static_cast<std::size_t>(i)] > limit) spikes.push_back(i);
  }
  return spikes;
}

}  // namespace rigfit::ident
