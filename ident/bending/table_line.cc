#include "ident/bending/table_line.h"

#include <gsl/gsl_cdf.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;
using Mask = std::vector<std::vector<char>>;

/// Least squares of a line (and parabola) common to the strokes.
struct Fit {
  double squares = 0, freedom = 0;
  double slope = 0, slope_variance_factor = 0;  // of the noise's variance
  double bend = 0, bend_variance_factor = 0;    // relative change of slope over the range
  std::vector<double> offsets;
  bool usable = false;
};

enum class Kind { spike, toe, top, turns, curve };
struct Candidate {
  Kind kind = Kind::spike;
  Mask mask;
  double share = 0;
  int rows = 0;
  std::size_t stroke = 0;
  Eigen::Index row = 0;
  double probability = 1;
};

class Table {
 public:
  Table(const std::vector<TableStroke>& strokes, double resolution, double noise)
      : strokes_(strokes), resolution_(resolution), noise_(noise) {
    double low = std::numeric_limits<double>::infinity(), high = -low, least = low, most = -low;
    for (const auto& stroke : strokes) {
      line_.used.emplace_back(static_cast<std::size_t>(stroke.x_m.size()), 1);
      low = std::min(low, stroke.x_m.minCoeff()), high = std::max(high, stroke.x_m.maxCoeff());
      least = std::min(least, stroke.load_N.minCoeff());
      most = std::max(most, stroke.load_N.maxCoeff());
    }
    low_ = low, range_ = high - low, load_range_ = most - least;
  }

  TableLine run() {
    if (!(range_ > 0 && load_range_ > 0)) return line_;
    // What the digits resolve counts unless the residuals about the line contradict it.
    const Fit all = fit(line_.used, false);
    if (resolution_ > 0 && all.usable && all.freedom > 0 &&
        gsl_cdf_chisq_P(all.squares / (resolution_ * resolution_), all.freedom) < 0.01) {
      resolution_ = 0;
    }
    std::size_t rows = 0;
    for (const auto& used : line_.used) rows += used.size();
    for (std::size_t step = 0; step <= rows / 5 && improve(); ++step) {
    }
    leave_turns_out();
    finish();
    return line_;
  }

 private:
  [[nodiscard]] Fit fit(const Mask& mask, bool parabola) const {
    Fit fit;
    std::vector<Eigen::Index> column(strokes_.size(), -1);
    Eigen::Index rows = 0, offsets = 0;
    for (std::size_t s = 0; s < strokes_.size(); ++s) {
      const auto here = std::count(mask[s].begin(), mask[s].end(), 1);
      if (here > 0) column[s] = offsets++;
      rows += here;
    }
    const Eigen::Index parameters = offsets + 1 + (parabola ? 1 : 0);
    fit.freedom = static_cast<double>(rows - parameters);
    if (rows < parameters) return fit;
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(rows, parameters);
    Eigen::VectorXd y(rows);
    Eigen::Index at = 0;
    double least = 1, most = 0;
    for (std::size_t s = 0; s < strokes_.size(); ++s) {
      for (std::size_t i = 0; i < mask[s].size(); ++i) {
        if (!mask[s][i]) continue;
        const auto k = static_cast<Eigen::Index>(i);
        const double u = (strokes_[s].x_m[k] - low_) / range_;
        least = std::min(least, u), most = std::max(most, u);
        A(at, column[s]) = 1;
        A(at, offsets) = u - 0.5;
        if (parabola) A(at, offsets + 1) = (u - 0.5) * (u - 0.5);
        y[at++] = strokes_[s].load_N[k];
      }
    }
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
    if (qr.rank() < parameters) return fit;
    const Eigen::VectorXd p = qr.solve(y);
    fit.squares = (y - A * p).squaredNorm();
    const Eigen::MatrixXd inverse = (A.transpose() * A).inverse();
    fit.slope = p[offsets] / range_;
    fit.slope_variance_factor = inverse(offsets, offsets) / (range_ * range_);
    if (parabola && p[offsets] != 0) {
      const double scale = 2 * (most - least) / p[offsets];
      fit.bend = scale * p[offsets + 1];
      fit.bend_variance_factor = scale * scale * inverse(offsets + 1, offsets + 1);
    }
    fit.offsets.assign(strokes_.size(), kNaN);
    for (std::size_t s = 0; s < strokes_.size(); ++s) {
      if (column[s] >= 0) {
        fit.offsets[s] = p[column[s]] - (low_ / range_ + 0.5) * p[offsets];
      }
    }
    fit.usable = true;
    return fit;
  }

  /// Variance of the noise by a fit, not below what the numbers resolve.
  [[nodiscard]] double variance(const Fit& fit) const {
    const double shown = fit.freedom > 0 ? fit.squares / fit.freedom : 0;
    return std::max({shown, noise_ * noise_, resolution_ * resolution_});
  }

  /// Probability that the line is right and `better` fits by chance as much better.
  [[nodiscard]] double probability(const Fit& line, const Fit& better) const {
    const double more = line.freedom - better.freedom;
    if (!better.usable || !(more > 0) || !(better.freedom >= 1) || !(better.slope > 0)) return 1;
    // Numbers are hardly ever good to more than six digits.
    const double floor = std::pow(1e-6 * load_range_, 2);
    const double F =
        std::max(0.0, line.squares - better.squares) / more / std::max(variance(better), floor);
    return gsl_cdf_fdist_Q(F, more, better.freedom);
  }

  template <typename Drop>
  [[nodiscard]] std::pair<Mask, int> without(Drop drop) const {
    Mask mask = line_.used;
    int dropped = 0;
    for (std::size_t s = 0; s < mask.size(); ++s) {
      for (std::size_t i = 0; i < mask[s].size(); ++i) {
        if (!mask[s][i] || !drop(s, static_cast<Eigen::Index>(i))) continue;
        mask[s][i] = 0;
        ++dropped;
      }
    }
    return {std::move(mask), dropped};
  }

  [[nodiscard]] double share(std::size_t s, Eigen::Index i) const {
    return (strokes_[s].x_m[i] - low_) / range_;
  }

  [[nodiscard]] std::vector<Candidate> candidates() const {
    std::vector<Candidate> list;
    const auto add = [&](Kind kind, std::pair<Mask, int> without, double share_out) {
      if (without.second == 0) return;
      Candidate one;
      one.kind = kind, one.mask = std::move(without.first), one.rows = without.second;
      one.share = share_out;
      list.push_back(std::move(one));
    };
    std::set<double> low, high;
    Eigen::Index longest = 0;
    for (std::size_t s = 0; s < strokes_.size(); ++s) {
      longest = std::max(longest, strokes_[s].x_m.size());
      for (Eigen::Index i = 0; i < strokes_[s].x_m.size(); ++i) {
        if (!line_.used[s][static_cast<std::size_t>(i)]) continue;
        const double u = share(s, i);
        (u <= 0.4 ? low : high).insert(u);
        add(Kind::spike, without([&](std::size_t t, Eigen::Index k) { return t == s && k == i; }),
            0);
        list.back().stroke = s, list.back().row = i;
      }
    }
    for (const double u : low) {
      add(Kind::toe, without([&](std::size_t s, Eigen::Index i) { return share(s, i) <= u; }), u);
    }
    for (const double u : high) {
      if (u < 0.6) continue;
      add(Kind::top, without([&](std::size_t s, Eigen::Index i) { return share(s, i) >= u; }),
          1 - u);
    }
    for (Eigen::Index m = 1; strokes_.size() > 1 && 5 * m <= 2 * longest; ++m) {
      add(Kind::turns, without([&](std::size_t, Eigen::Index i) { return i < m; }), 0);
      list.back().rows = static_cast<int>(m);
    }
    Candidate curve;
    curve.kind = Kind::curve, curve.mask = line_.used;
    list.push_back(std::move(curve));
    return list;
  }

  /// Takes the most significant alternative to the line; false: the line stands.
  bool improve() {
    const Fit line = fit(line_.used, false);
    if (!line.usable || line.freedom < 2) return false;
    auto list = candidates();
    for (auto& one : list) {
      one.probability = probability(line, fit(one.mask, one.kind == Kind::curve));
    }
    const auto best = std::min_element(list.begin(), list.end(), [](const auto& a, const auto& b) {
      return a.probability < b.probability;
    });
    if (!(best->probability * static_cast<double>(list.size()) < 0.01)) return false;
    const double curve = list.back().probability;
    if (best->kind == Kind::curve || (best->kind != Kind::spike && best->kind != Kind::turns &&
                                      curve < 10 * best->probability)) {
      line_.curved = true;
      return false;
    }
    line_.used = best->mask;
    if (best->kind == Kind::spike) line_.spikes.emplace_back(best->stroke, best->row);
    if (best->kind == Kind::toe) line_.toe_share = std::max(line_.toe_share, best->share);
    if (best->kind == Kind::top) line_.top_share = std::max(line_.top_share, best->share);
    if (best->kind == Kind::turns) line_.turn_rows = std::max(line_.turn_rows, best->rows);
    return true;
  }

  /// Loading and unloading lines apart: wires rub, and after a turn they stiffen the strand. The
  /// first quarter of every stroke goes; what that changes is added to the uncertainty.
  void leave_turns_out() {
    const Fit all = fit(line_.used, false);
    if (line_.curved || !all.usable || all.freedom < 3) return;
    double up = 0, down = 0, ups = 0, downs = 0, rows_up = 0, rows_down = 0;
    for (std::size_t s = 0; s < strokes_.size(); ++s) {
      if (!std::isfinite(all.offsets[s])) continue;
      const auto rows = std::count(line_.used[s].begin(), line_.used[s].end(), 1);
      auto& sum = strokes_[s].loading ? up : down;
      sum += all.offsets[s];
      (strokes_[s].loading ? ups : downs) += 1;
      (strokes_[s].loading ? rows_up : rows_down) += static_cast<double>(rows);
    }
    if (ups == 0 || downs == 0) return;
    const double apart = up / ups - down / downs;
    const double std = std::sqrt(variance(all) * (1 / rows_up + 1 / rows_down));
    if (!(apart > gsl_cdf_tdist_Qinv(0.005, all.freedom) * std)) return;
    line_.hysteresis_N = 0.5 * apart;
    const auto [mask, dropped] = without([&](std::size_t s, Eigen::Index i) {
      const auto& x = strokes_[s].x_m;
      return std::abs(x[i] - x[0]) < 0.27 * std::abs(x[x.size() - 1] - x[0]);
    });
    const Fit rest = fit(mask, false);
    if (!rest.usable || rest.freedom < 2 || !(rest.slope > 0)) {
      line_.friction_std_N_m = 0.5 * apart / range_;
      return;
    }
    line_.used = mask;
    line_.turn_rows = std::max(line_.turn_rows, 1);
    // Against all rows but spikes: what is left of the transient is at most of that size.
    Mask whole = line_.used;
    for (auto& stroke : whole) std::fill(stroke.begin(), stroke.end(), 1);
    for (const auto& [stroke, row] : line_.spikes) whole[stroke][static_cast<std::size_t>(row)] = 0;
    const Fit with = fit(whole, false);
    line_.friction_std_N_m =
        std::max(std::abs(rest.slope - all.slope), std::abs(rest.slope - with.slope));
  }

  void finish() {
    const Fit best = fit(line_.used, false);
    if (!best.usable || best.freedom < 1 || !(best.slope > 0)) return;
    const double noise2 = variance(best);
    line_.noise_N = std::sqrt(noise2);
    line_.residual_N = std::sqrt(best.squares / best.freedom);
    line_.degrees_of_freedom = best.freedom;
    // Errors in both coordinates, equal in relation to their ranges: OLS over its correlation.
    double Sxx = 0, Syy = 0;
    line_.offsets_N = best.offsets;
    std::vector<double> own;
    double chi = 0, weights = 0;
    for (std::size_t s = 0; s < strokes_.size(); ++s) {
      double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
      for (std::size_t i = 0; i < line_.used[s].size(); ++i) {
        if (!line_.used[s][i]) continue;
        const auto k = static_cast<Eigen::Index>(i);
        n += 1, x += strokes_[s].x_m[k], y += strokes_[s].load_N[k];
      }
      if (n > 0) x /= n, y /= n;
      for (std::size_t i = 0; i < line_.used[s].size(); ++i) {
        if (!line_.used[s][i]) continue;
        const auto k = static_cast<Eigen::Index>(i);
        const double dx = strokes_[s].x_m[k] - x, dy = strokes_[s].load_N[k] - y;
        xx += dx * dx, xy += dx * dy, yy += dy * dy;
      }
      Sxx += xx, Syy += yy;
      line_.stroke_slopes.push_back(xx > 0 ? signal::Estimate{xy / xx, std::sqrt(noise2 / xx)}
                                           : signal::Estimate{});
      if (!(xx > 0)) continue;
      chi += xx * std::pow(xy / xx - best.slope, 2) / std::max(noise2, 1e-300);
      weights += 1;
    }
    if (weights > 1 && best.freedom > weights - 1) {
      line_.strokes_differ =
          gsl_cdf_fdist_Q(chi / (weights - 1), weights - 1, best.freedom - weights + 1) < 0.05;
    }
    line_.slope_N_m = std::sqrt(Syy / Sxx);
    line_.slope_std_N_m = std::sqrt(noise2 * best.slope_variance_factor);
    line_.usable = true;

    const Fit parabola = fit(line_.used, true);
    line_.curvature = parabola.bend;
    line_.curvature_half = std::numeric_limits<double>::infinity();
    if (parabola.usable && parabola.freedom >= 1) {
      line_.curvature_half = gsl_cdf_tdist_Qinv(0.025, parabola.freedom) *
                             std::sqrt(variance(parabola) * parabola.bend_variance_factor);
      line_.curved = line_.curved || probability(best, parabola) < 0.01;
    }
  }

  const std::vector<TableStroke>& strokes_;
  double resolution_ = 0, noise_ = 0;
  double low_ = 0, range_ = 0, load_range_ = 0;
  TableLine line_;
};

}  // namespace

TableLine fit_table_line(const std::vector<TableStroke>& strokes, double resolution_std_N,
                         double noise_std_N) {
  if (strokes.empty()) return {};
  return Table(strokes, resolution_std_N, noise_std_N).run();
}

double resolution_of(const Eigen::VectorXd& values, double unit) {
  if (values.size() < 2 || !(unit > 0)) return 0;
  const Eigen::ArrayXd numbers = values.array() / unit;
  const double range = numbers.maxCoeff() - numbers.minCoeff();
  if (!(range > 0)) return 0;
  // Set in equal steps, up or down.
  Eigen::ArrayXd steps =
      (numbers.tail(numbers.size() - 1) - numbers.head(numbers.size() - 1)).abs();
  if (numbers.size() > 2 && steps.maxCoeff() - steps.minCoeff() < 1e-6 * range) return 0;
  double step = std::pow(10, std::floor(std::log10(range)));
  for (; step > 1e-3 * range; step /= 10) {
    const Eigen::ArrayXd multiples = numbers / step;
    // Units of a power of ten and their conversion leave rounding.
    if ((multiples - multiples.round()).abs().maxCoeff() < 1e-6) return step * unit;
  }
  return 0;
}

}  // namespace rigfit::ident
