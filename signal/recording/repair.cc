#include "signal/recording/repair.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "signal/numerics/scaled_gram.h"

namespace rigfit::signal {
namespace {

/// Value at `t` of the polynomial through the points (Neville).
double through(std::vector<double> t, std::vector<double> y, double at) {
  for (std::size_t level = 1; level < t.size(); ++level) {
    for (std::size_t k = 0; k + level < t.size(); ++k) {
      y[k] = ((at - t[k + level]) * y[k] - (at - t[k]) * y[k + 1]) / (t[k] - t[k + level]);
    }
  }
  return y[0];
}

long bridge(Eigen::VectorXd& x, int longest, long& gaps) {
  const Eigen::VectorXd had = x;
  const Eigen::Index n = x.size();
  long mended = 0;
  for (Eigen::Index k = 0; k < n;) {
    if (std::isfinite(had[k])) {
      ++k;
      continue;
    }
    Eigen::Index end = k;
    while (end < n && !std::isfinite(had[end])) ++end;
    const bool inside = k > 0 && end < n;
    if (inside && end - k <= longest) {
      std::vector<double> t, y;
      for (const Eigen::Index j : {k - 2, k - 1, end, end + 1}) {
        if (j < 0 || j >= n || !std::isfinite(had[j])) continue;
        t.push_back(static_cast<double>(j - k));
        y.push_back(had[j]);
      }
      for (Eigen::Index j = k; j < end; ++j) x[j] = through(t, y, static_cast<double>(j - k));
      mended += end - k;
      ++gaps;
    }
    k = end;
  }
  return mended;
}

/// Least squares over the samples there are, in Legendre polynomials of time scaled to -1 .. 1.
void detrend(Eigen::VectorXd& x, int degree) {
  const Eigen::Index n = x.size();
  const int terms = degree + 1;
  const auto basis = [&](Eigen::Index k) {
    Eigen::VectorXd p(terms);
    const double t = n > 1 ? 2 * static_cast<double>(k) / static_cast<double>(n - 1) - 1 : 0;
    p[0] = 1;
    if (terms > 1) p[1] = t;
    for (int m = 2; m < terms; ++m) p[m] = ((2 * m - 1) * t * p[m - 1] - (m - 1) * p[m - 2]) / m;
    return p;
  };
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(terms, terms);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(terms);
  long count = 0;
  for (Eigen::Index k = 0; k < n; ++k) {
    if (!std::isfinite(x[k])) continue;
    const Eigen::VectorXd p = basis(k);
    normal += p * p.transpose();
    right += p * x[k];
    ++count;
  }
  if (count < terms) return;
  const ScaledGram factor(normal);
  if (!factor.usable()) return;
  const Eigen::VectorXd c = factor.solve_vector(right);
  for (Eigen::Index k = 0; k < n; ++k) x[k] -= basis(k).dot(c);
}

}  // namespace

Recording repaired(const Recording& recording, const RepairOptions& options) {
  Recording out = recording;
  for (auto& channel : out.channels) {
    if (options.bridge_samples > 0) {
      long gaps = 0;
      const long mended = bridge(channel.samples, options.bridge_samples, gaps);
      if (mended > 0) {
        channel.missing_samples -= mended;
        out.notes.push_back({"bridged",
                             std::to_string(mended) + " missing samples in " +
                                 std::to_string(gaps) + " gaps bridged by cubics",
                             channel.name});
      }
    }
    if (options.detrend_degree >= 0) {
      detrend(channel.samples, options.detrend_degree);
      out.notes.push_back(
          {"detrended",
           options.detrend_degree == 0
               ? std::string("mean taken away")
               : "polynomial of degree " + std::to_string(options.detrend_degree) + " taken away",
           channel.name});
    }
  }
  return out;
}

}  // namespace rigfit::signal
