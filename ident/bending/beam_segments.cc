#include "ident/bending/beam_segments.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "ident/bending/deming_line.h"
#include "ident/bending/table_line.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

constexpr int kMostSegments = 5;
constexpr std::size_t kLeastBins = 3;  // bins in a segment
constexpr double kToeLoad = 0.25;      // share of the load range
constexpr double kStopSlope = 3;

struct CurveBin {
  double x = 0, y = 0;  ///< means, relative to the ranges
  int rows = 0;
  Eigen::Index first = 0, last = 0;  ///< places along the stroke
};

/// Sums over bins, of which a line's squared distances follow.
struct BinSums {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  void add(const CurveBin& bin) {
    n += 1, x += bin.x, y += bin.y;
    xx += bin.x * bin.x, xy += bin.x * bin.y, yy += bin.y * bin.y;
  }
  [[nodiscard]] BinSums minus(const BinSums& before) const {
    return {n - before.n,   x - before.x,   y - before.y,
            xx - before.xx, xy - before.xy, yy - before.yy};
  }
  [[nodiscard]] std::array<double, 3> scatter() const {
    return {xx - x * x / n, xy - x * y / n, yy - y * y / n};
  }
  /// Squared distances from the best line.
  [[nodiscard]] double squares() const {
    const auto [a, b, c] = scatter();
    return std::max(0.0, 0.5 * (a + c - std::hypot(a - c, 2 * b)));
  }
  /// Slope dy / dx of the best line.
  [[nodiscard]] double slope() const {
    const auto [a, b, c] = scatter();
    const double angle = 0.5 * std::atan2(2 * b, a - c);
    return std::tan(std::min(angle, 1.5707963));
  }
};

struct CurvePart {
  std::size_t first = 0, last = 0;  ///< bins, inclusive
  double slope = 0;                 ///< relative to the ranges
};

class ElasticSearch {
 public:
  ElasticSearch(const StrokeRange& run, const StrokeData& data) : run_(run), data_(data) {
    loading_ = run.direction > 0;
    rows_ = run.last - run.first + 1;
  }

  ElasticPart run() {
    BendingStroke& stroke = part_.stroke;
    stroke.loading = loading_;
    stroke.first = run_.first, stroke.last = run_.last;
    leave_break_out();
    fill_bins();
    if (bins_.size() < 2 * kLeastBins) return std::move(part_);
    find_segments();
    choose();
    return std::move(part_);
  }

 private:
  [[nodiscard]] Eigen::Index row(Eigen::Index place) const {
    return loading_ ? run_.first + place : run_.last - place;
  }
  [[nodiscard]] double x(Eigen::Index place) const { return data_.x[row(place)]; }
  [[nodiscard]] double y(Eigen::Index place) const { return data_.load[row(place)]; }

  void note(std::string code, std::string message, bool refuses = false) {
    part_.findings.push_back({std::move(code), std::move(message), refuses});
  }
  [[nodiscard]] std::string at(Eigen::Index place) const {
    return fmt::format("{:.3g} mm, {:.4g} N", 1e3 * x(place), y(place));
  }

  /// What lies beyond the largest load of a loading that falls by a tenth afterwards.
  void leave_break_out() {
    if (!loading_) return;
    const auto load = data_.load.segment(run_.first, rows_);
    Eigen::Index peak = 0;
    const double highest = load.maxCoeff(&peak);
    const double after = load.tail(rows_ - peak).minCoeff();
    if (highest - after < 0.1 * data_.load_range) return;
    note("break", fmt::format("Check for a break or slip: the load falls from its largest value "
                              "({}) by {:.0f} %, and the rows after it are left out",
                              at(peak), 100 * (highest - after) / data_.load_range));
    rows_ = peak + 1;
  }

  void fill_bins() {
    double low_x = x(0), high_x = low_x, low_y = y(0), high_y = low_y;
    for (Eigen::Index i = 0; i < rows_; ++i) {
      low_x = std::min(low_x, x(i)), high_x = std::max(high_x, x(i));
      low_y = std::min(low_y, y(i)), high_y = std::max(high_y, y(i));
    }
    if (!(high_x > low_x && high_y > low_y)) return;
    range_x_ = high_x - low_x, range_y_ = high_y - low_y;
    const auto count = std::clamp<Eigen::Index>(rows_ / 4, 8, 60);
    std::vector<CurveBin> bins(static_cast<std::size_t>(count));
    for (Eigen::Index i = 0; i < rows_; ++i) {
      const double u = (x(i) - low_x) / range_x_, v = (y(i) - low_y) / range_y_;
      const auto k = std::min<Eigen::Index>(
          count - 1, static_cast<Eigen::Index>(0.5 * (u + v) * static_cast<double>(count)));
      CurveBin& bin = bins[static_cast<std::size_t>(k)];
      if (bin.rows++ == 0) bin.first = i;
      bin.last = i;
      bin.x += u, bin.y += v;
    }
    for (CurveBin& bin : bins) {
      if (bin.rows == 0) continue;
      bin.x /= bin.rows, bin.y /= bin.rows;
      bins_.push_back(bin);
    }
    sums_.resize(bins_.size() + 1);
    for (std::size_t k = 0; k < bins_.size(); ++k) {
      sums_[k + 1] = sums_[k];
      sums_[k + 1].add(bins_[k]);
    }
    const auto values = [&](const Eigen::VectorXd& all) {
      return all.segment(run_.first, run_.last - run_.first + 1).eval();
    };
    const double resolution = std::hypot(resolution_of(values(data_.load), 1) / range_y_,
                                         resolution_of(values(data_.deflection), 1) / range_x_);
    // Numbers are hardly ever good to more than six digits.
    floor2_ = resolution * resolution / 12 + 1e-12;
  }

  [[nodiscard]] BinSums between(std::size_t first, std::size_t last) const {
    return sums_[last + 1].minus(sums_[first]);
  }

  void find_segments() {
    const std::size_t n = bins_.size();
    const double infinity = std::numeric_limits<double>::infinity();
    // best[k][j]: bins up to j by k + 1 segments; the last of them begins at from[k][j].
    std::vector<std::vector<double>> best(kMostSegments, std::vector<double>(n, infinity));
    std::vector<std::vector<std::size_t>> from(kMostSegments, std::vector<std::size_t>(n, 0));
    for (std::size_t j = kLeastBins - 1; j < n; ++j) best[0][j] = between(0, j).squares();
    for (std::size_t k = 1; k < kMostSegments; ++k) {
      for (std::size_t j = (k + 1) * kLeastBins - 1; j < n; ++j) {
        for (std::size_t i = k * kLeastBins; i + kLeastBins <= j + 1; ++i) {
          const double squares = best[k - 1][i - 1] + between(i, j).squares();
          if (squares < best[k][j]) best[k][j] = squares, from[k][j] = i;
        }
      }
    }
    std::size_t taken = 0;
    for (std::size_t k = 1; k < kMostSegments; ++k) {
      const double freedom = static_cast<double>(n) - 3 * static_cast<double>(k) - 2;
      if (freedom < 1 || !std::isfinite(best[k][n - 1])) break;
      const double more = 3 * static_cast<double>(k - taken);
      const double variance = std::max(best[k][n - 1] / freedom, floor2_);
      const double F = std::max(0.0, best[taken][n - 1] - best[k][n - 1]) / more / variance;
      const double places = std::pow(static_cast<double>(n), static_cast<double>(k - taken));
      if (gsl_cdf_fdist_Q(F, more, freedom) * places < 0.01) taken = k;
    }
    std::size_t last = n - 1;
    for (std::size_t k = taken + 1; k-- > 0;) {
      const std::size_t first = k == 0 ? 0 : from[k][last];
      parts_.insert(parts_.begin(), CurvePart{first, last, between(first, last).slope()});
      last = first == 0 ? 0 : first - 1;
    }
    merge();
  }

  void merge() {
    while (parts_.size() > 1) {
      std::size_t nearest = 0;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k + 1 < parts_.size(); ++k) {
        const double a = parts_[k].slope, b = parts_[k + 1].slope;
        const double apart = std::abs(a - b) / std::max(std::abs(a), std::abs(b));
        if (apart < least) least = apart, nearest = k;
      }
      if (!(least < kCurvatureWarning)) return;
      CurvePart& one = parts_[nearest];
      one.last = parts_[nearest + 1].last;
      one.slope = between(one.first, one.last).slope();
      parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(nearest) + 1);
    }
  }

  void choose() {
    std::size_t k = 0;
    while (k + 1 < parts_.size() && bins_[parts_[k].last].y <= kToeLoad &&
           parts_[k + 1].slope > parts_[k].slope) {
      const CurveBin& end = bins_[parts_[k].last];
      if (end.x > 0.8 && end.y > 0.05) {
        note("curved",
             fmt::format(
                 "Cut off a toe before {0} or a stop after it: the curve bends upwards at {0}, "
                 "after most of the deflection and little of the load",
                 at(end.last)),
             true);
        return;
      }
      ++k;
    }
    if (k > 0) {
      note("toe", fmt::format("the rows up to {} are left out as a toe (supports and slack settle)",
                              at(bins_[parts_[k - 1].last].last)));
    }
    const CurvePart& elastic = parts_[k];
    if (k + 1 < parts_.size()) {
      const double ratio = parts_[k + 1].slope / elastic.slope;
      const std::string place = at(bins_[elastic.last].last);
      if (ratio >= kStopSlope) {
        note("stop",
             fmt::format("Deflect less, or check for a stop or a sensor's end: from {} on the "
                         "load rises {:.1f} times as steeply, which is left out",
                         place, ratio));
      } else if (ratio > 1) {
        note("curved",
             fmt::format(
                 "Deflect less, or check the supports: from {} on the slope rises by {:.0f} %, "
                 "and a stiffening load-deflection diagram has no single EI",
                 place, 100 * (ratio - 1)),
             true);
      } else {
        note("yield", fmt::format("Check for yield, slip or large deflection: from {} on the slope "
                                  "falls to {:.0f} % of the elastic part's, which is left out",
                                  place, 100 * std::max(0.0, ratio)));
      }
    }
    fit(elastic, k > 0, k + 1 < parts_.size());
  }

  void fit(const CurvePart& elastic, bool toe, bool beyond) {
    std::size_t first = elastic.first, last = elastic.last;
    // The bins at a break hold some of both sides.
    if (toe && last - first >= kLeastBins) ++first;
    if (beyond && last - first >= kLeastBins) --last;
    const Eigen::Index a = row(bins_[first].first), b = row(bins_[last].last);
    BendingStroke& stroke = part_.stroke;
    stroke.used_first = std::min(a, b), stroke.used_last = std::max(a, b);
    const Eigen::Index n = stroke.used_last - stroke.used_first + 1;
    const DemingLine line = fit_deming_line(data_.x.segment(stroke.used_first, n),
                                            data_.load.segment(stroke.used_first, n),
                                            data_.deflection_noise, data_.load_noise, true);
    if (!line.usable || n < 8) return;
    // Where on the part the slope is that of small deflections is not known: uniform.
    const double bent = std::abs(line.curvature) * line.slope / std::sqrt(12.0);
    stroke.stiffness_N_m = {line.slope, std::hypot(line.slope_std, bent)};
    stroke.offset_N = line.offset;
    stroke.residual_rms_N = line.residual_rms;
    stroke.curvature = line.curvature;
    stroke.curvature_std = line.curvature_std;
    part_.degrees_of_freedom = line.degrees_of_freedom;
  }

  const StrokeRange& run_;
  const StrokeData& data_;
  bool loading_ = true;
  Eigen::Index rows_ = 0;
  double range_x_ = 0, range_y_ = 0, floor2_ = 0;
  std::vector<CurveBin> bins_;
  std::vector<BinSums> sums_;
  std::vector<CurvePart> parts_;
  ElasticPart part_;
};

}  // namespace

ElasticPart find_elastic_part(const StrokeRange& run, const StrokeData& data) {
  ElasticPart part = ElasticSearch(run, data).run();
  if (!(part.stroke.stiffness_N_m.value > 0)) {
    part.stroke.stiffness_N_m = {signal::kNaN, signal::kNaN};
  }
  return part;
}

}  // namespace rigfit::ident
