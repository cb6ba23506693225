#include "ident/bending_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "ident/deming_line.h"

namespace rigfit::ident {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Noise of one sample from second differences, which a smooth signal hardly has.
double noise_of(const Eigen::VectorXd& x) {
  if (x.size() < 20) return 0;
  std::vector<double> seconds;
  double squares = 0;
  for (Eigen::Index i = 1; i + 1 < x.size(); ++i) {
    seconds.push_back(std::abs(x[i - 1] - 2 * x[i] + x[i + 1]));
    squares += seconds.back() * seconds.back();
  }
  const double robust = 1.4826 * median_of(seconds) / std::sqrt(6.0);
  // A coarse converter repeats its value more often than not.
  return robust > 0 ? robust : std::sqrt(squares / static_cast<double>(seconds.size()) / 6);
}

struct Range {
  Eigen::Index first, last;  // inclusive
  int direction;
};

// Runs of one direction: a turn counts when the signal has come back by `least`.
std::vector<Range> strokes_of(const Eigen::VectorXd& d, double least) {
  std::vector<Range> runs;
  Eigen::Index start = 0, extreme = 0;
  int direction = 0;
  for (Eigen::Index i = 1; i < d.size(); ++i) {
    if (direction == 0) {
      if (std::abs(d[i] - d[start]) >= least) {
        direction = d[i] > d[start] ? 1 : -1;
        // The stroke begins at the last sample before it left.
        for (Eigen::Index k = start; k <= i; ++k) {
          if (direction * (d[k] - d[start]) <= 0) start = k;
        }
        extreme = i;
      }
      continue;
    }
    if (direction * (d[i] - d[extreme]) > 0) extreme = i;
    if (direction * (d[extreme] - d[i]) >= least) {
      runs.push_back({start, extreme, direction});
      start = extreme;
      extreme = i;
      direction = -direction;
    }
  }
  if (direction != 0) runs.push_back({start, extreme, direction});
  return runs;
}

// Exact tables have lines without residuals; rounding keeps their variance from being zero.
double variance_of(const BendingStroke& stroke) {
  const double std = std::max(stroke.stiffness_N_m.std, 1e-10 * stroke.stiffness_N_m.value);
  return std * std;
}

class Analysis {
 public:
  Analysis(const BendingRecord& record, const BendingTestOptions& options) : options_(options) {
    take_complete_rows(record);
  }

  BendingTestResult run() {
    const Eigen::Index n = d_.size();
    if (n < 4) {
      refuse("too_few_points",
             fmt::format("{} complete rows of tension, load and deflection; at least 4 are needed",
                         n));
      return finish();
    }
    range_d_ = d_.maxCoeff() - d_.minCoeff();
    range_Q_ = Q_.maxCoeff() - Q_.minCoeff();
    if (!(range_d_ > 0 && range_Q_ > 0)) {
      refuse("no_loading", "load or deflection never changes: nothing was loaded");
      return finish();
    }
    result_.load_noise_N = options_.load_noise_N > 0 ? options_.load_noise_N : noise_of(Q_);
    result_.deflection_noise_m =
        options_.deflection_noise_m > 0 ? options_.deflection_noise_m : noise_of(d_);
    mean_tension_ = P_.mean();
    if (!(mean_tension_ > 0)) {
      refuse("no_tension", fmt::format("the mean tension is {:.4g} N; check the sign and zero of "
                                       "the tension channel",
                                       mean_tension_));
      return finish();
    }
    if (Q_.dot((d_.array() - d_.mean()).matrix()) < 0) d_ = -d_;  // deflection counted against load

    // Zero of the deflection: the least there is, within its noise.
    const double lowest = d_.minCoeff();
    std::vector<double> unloaded;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (d_[i] <= lowest + 6 * result_.deflection_noise_m) unloaded.push_back(d_[i]);
    }
    zero_ = median_of(unloaded);

    find_clamp_slip();
    fit_strokes();
    if (!result_.strokes.empty()) judge_strokes();
    return finish();
  }

 private:
  void take_complete_rows(const BendingRecord& record) {
    const Eigen::Index n = record.load_N.size();
    if (record.deflection_m.size() != n || record.tension_N.size() != n) {
      throw std::invalid_argument("bending test: channels of different lengths");
    }
    if (!(options_.span_m.value > 0)) {
      throw std::invalid_argument("bending test: the span must be positive");
    }
    P_.resize(n), Q_.resize(n), d_.resize(n);
    Eigen::Index kept = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!std::isfinite(record.tension_N[i]) || !std::isfinite(record.load_N[i]) ||
          !std::isfinite(record.deflection_m[i])) {
        continue;
      }
      P_[kept] = record.tension_N[i];
      Q_[kept] = record.load_N[i];
      d_[kept++] = record.deflection_m[i];
    }
    P_.conservativeResize(kept), Q_.conservativeResize(kept), d_.conservativeResize(kept);
    if (kept < n) {
      note("missing", fmt::format("{} of {} rows miss a value and were left out", n - kept, n));
    }
  }

  void note(std::string code, std::string message) {
    result_.findings.push_back({std::move(code), std::move(message), false});
  }
  void refuse(std::string code, std::string message) {
    result_.findings.push_back({std::move(code), std::move(message), true});
    result_.refused = true;
  }
  BendingTestResult finish() { return std::move(result_); }

  // While the cable is deflected its tension can only rise; what it loses for good slipped.
  void find_clamp_slip() {
    const auto least = std::max(0.2 * range_d_, 6 * result_.deflection_noise_m);
    const double noise = std::max(noise_of(P_), 0.0);
    double worst = 0;
    for (const Range& run : strokes_of(d_, least)) {
      if (run.direction < 0) continue;
      double highest = -std::numeric_limits<double>::infinity();
      for (Eigen::Index i = run.first + 2; i + 2 <= run.last; ++i) {
        const double local = median_of({P_[i - 2], P_[i - 1], P_[i], P_[i + 1], P_[i + 2]});
        highest = std::max(highest, local);
        worst = std::max(worst, highest - local);
      }
    }
    if (worst > std::max(0.02 * mean_tension_, 8 * noise)) {
      const std::string message = fmt::format(
          "the tension fell by {:.3g} N ({:.1f} %) while the cable was being loaded: a clamp "
          "slipped or the frame gave way",
          worst, 100 * worst / mean_tension_);
      if (worst > 0.1 * mean_tension_) {
        refuse("clamp_slip", message + "; tighten the clamps and repeat");
      } else {
        note("clamp_slip", message + "; the tension is used as measured");
      }
    }
    // Return to zero: load gone, deflection not.
    const double low = Q_.minCoeff() + 0.05 * range_Q_;
    const Eigen::Index n = d_.size();
    if (Q_[0] <= low && Q_[n - 1] <= low) {
      const double set = d_[n - 1] - d_[0];
      if (std::abs(set) > std::max(0.03 * range_d_, 8 * result_.deflection_noise_m)) {
        note("set", fmt::format("after unloading {:.3g} m of deflection is left ({:.0f} % of the "
                                "largest): slip in the clamps, or the strand settled",
                                set, 100 * std::abs(set) / range_d_));
      }
    }
  }

  // g(P): compliance at the mean tension over that at the tension of the moment.
  Eigen::VectorXd tension_corrected(double EI) const {
    const double span = options_.span_m.value;
    Eigen::VectorXd x(d_.size());
    const double mean = EI > 0 ? midspan_compliance(EI, mean_tension_, span) : 1 / mean_tension_;
    for (Eigen::Index i = 0; i < d_.size(); ++i) {
      const double P = std::max(P_[i], 0.0);
      const double g = EI > 0 ? mean / midspan_compliance(EI, P, span) : P / mean_tension_;
      x[i] = (d_[i] - zero_) * g;
    }
    return x;
  }

  int load_drops(const Range& run) const {
    const double least = std::max(0.01 * range_Q_, 8 * result_.load_noise_N);
    double highest = run.direction * Q_[run.first];
    bool falling = false;
    int drops = 0;
    double lowest = highest;
    for (Eigen::Index i = run.first + 1; i <= run.last; ++i) {
      const double q = run.direction * Q_[i];
      if (!falling && q > highest) highest = q;
      if (!falling && highest - q > least) {
        ++drops;
        falling = true;
        lowest = q;
      }
      if (falling) {
        lowest = std::min(lowest, q);
        if (q - lowest > 0.5 * least) {
          falling = false;
          highest = q;
        }
      }
    }
    return drops;
  }

  DemingLine line_through(const Eigen::VectorXd& x, Eigen::Index first, Eigen::Index last,
                          bool uncertainty) const {
    const Eigen::Index n = last - first + 1;
    return fit_deming_line(x.segment(first, n), Q_.segment(first, n), result_.deflection_noise_m,
                           result_.load_noise_N, uncertainty);
  }

  // Straight part of a stroke: a line through its middle, followed outwards to where the local mean
  // leaves it.
  BendingStroke fit_stroke(const Range& run, const Eigen::VectorXd& x) const {
    BendingStroke stroke;
    stroke.loading = run.direction > 0;
    stroke.first = run.first;
    stroke.last = run.last;
    stroke.load_drops = load_drops(run);
    const Eigen::Index samples = run.last - run.first + 1;
    const double start = d_[run.first], travel = d_[run.last] - start;
    const auto share = [&](Eigen::Index i) { return (d_[i] - start) / travel; };
    Eigen::Index earliest = run.first;
    if (samples >= 20) {
      while (share(earliest) < options_.turn_share) ++earliest;
    }
    // Toe lies at the bottom, stop and friction's turn at the top of the loading stroke.
    const double from = stroke.loading ? 0.35 : 0.15, to = stroke.loading ? 0.85 : 0.65;
    Eigen::Index first = earliest, last = run.last;
    const Eigen::Index least = std::min<Eigen::Index>(4, last - first + 1);
    while (first + least <= last && share(first) < from) ++first;
    while (last - least >= first && share(last) > to) --last;
    DemingLine line = line_through(x, first, last, false);

    const Eigen::Index half = samples / 40;
    const double averaged = std::sqrt(static_cast<double>(2 * half + 1));
    Eigen::VectorXd sums(samples + 1);  // of residuals before each sample, clipped
    for (int pass = 0; pass < 4 && line.usable; ++pass) {
      const double noise =
          std::hypot(result_.load_noise_N, line.slope * result_.deflection_noise_m);
      const double limit = std::max(options_.straightness * range_Q_, 4 * noise / averaged);
      const double clip = 3 * limit + 4 * noise;  // one wild sample moves no mean beyond the limit
      sums[0] = 0;
      for (Eigen::Index k = 0; k < samples; ++k) {
        const double r = Q_[run.first + k] - line.offset - line.slope * x[run.first + k];
        sums[k + 1] = sums[k] + std::clamp(r, -clip, clip);
      }
      const auto off = [&](Eigen::Index i) {
        const Eigen::Index low = std::max<Eigen::Index>(0, i - run.first - half);
        const Eigen::Index high = std::min(samples, i - run.first + half + 1);
        return std::abs(sums[high] - sums[low]) / static_cast<double>(high - low) > limit;
      };
      Eigen::Index new_first = first, new_last = last;
      while (new_first > earliest && !off(new_first - 1)) --new_first;
      while (new_first + least < new_last && off(new_first)) ++new_first;
      while (new_last < run.last && !off(new_last + 1)) ++new_last;
      while (new_last - least > new_first && off(new_last)) --new_last;
      if (new_first == first && new_last == last) break;
      first = new_first;
      last = new_last;
      line = line_through(x, first, last, false);
    }
    line = line_through(x, first, last, true);
    stroke.used_first = first;
    stroke.used_last = last;
    stroke.stiffness_N_m = {line.usable ? line.slope : kNaN, line.usable ? line.slope_std : kNaN};
    stroke.offset_N = line.offset;
    stroke.residual_rms_N = line.residual_rms;
    stroke.curvature = line.curvature;
    stroke.curvature_std = line.curvature_std;
    freedom_ = line.degrees_of_freedom;
    return stroke;
  }

  void fit_strokes() {
    const double least = std::max(0.2 * range_d_, 6 * result_.deflection_noise_m);
    std::vector<Range> runs;
    for (const Range& run : strokes_of(d_, least)) {
      const bool whole = std::abs(d_[run.last] - d_[run.first]) >= 0.5 * range_d_;
      if (whole && run.last - run.first + 1 >= 4) runs.push_back(run);
    }
    if (runs.empty()) {
      refuse("no_loading", "no loading or unloading stroke of four samples or more was found");
      return;
    }
    double EI = 0, before = -1;
    for (int pass = 0; pass < 8; ++pass) {
      const Eigen::VectorXd x = tension_corrected(EI);
      result_.strokes.clear();
      std::vector<double> freedoms;
      for (const Range& run : runs) {
        BendingStroke stroke = fit_stroke(run, x);
        if (!(stroke.stiffness_N_m.value > 0) || !std::isfinite(stroke.stiffness_N_m.std)) continue;
        result_.strokes.push_back(stroke);
        freedoms.push_back(freedom_);
      }
      if (result_.strokes.empty()) {
        refuse("no_slope",
               "no stroke has a straight part with a positive slope of load over "
               "deflection");
        return;
      }
      pool(freedoms);
      const double ratio = 4 * mean_tension_ * result_.compliance_m_N.value / options_.span_m.value;
      EI = 0;  // softer than a string: g is that of a string
      if (ratio < 1) {
        const double lambda = lambda_from_bending_ratio(ratio).lambda;
        EI = mean_tension_ * std::pow(options_.span_m.value / lambda, 2) / 4;
      }
      if (std::abs(EI - before) <= 1e-7 * EI) break;
      before = EI;
    }
    result_.tension_N = {mean_tension_, options_.tension_calibration_std * mean_tension_};
    result_.stiffness = stiffness_from_compliance(
        {result_.compliance_m_N, result_.tension_N, options_.span_m, result_.degrees_of_freedom});
  }

  void pool(const std::vector<double>& freedoms) {
    const auto& strokes = result_.strokes;
    const auto count = static_cast<double>(strokes.size());
    double weight = 0, weight2 = 0, mean = 0;
    for (const auto& s : strokes) {
      const double w = 1 / variance_of(s);
      weight += w, weight2 += w * w, mean += w * s.stiffness_N_m.value;
    }
    mean /= weight;
    double chi = 0;
    for (const auto& s : strokes) {
      chi += std::pow(s.stiffness_N_m.value - mean, 2) / variance_of(s);
    }
    // Variance between strokes beyond what their own lines promise.
    const double between =
        count > 1 ? std::max(0.0, (chi - (count - 1)) / (weight - weight2 / weight)) : 0;
    double pooled_weight = 0, pooled = 0, within = 0, welch = 0;
    for (std::size_t i = 0; i < strokes.size(); ++i) {
      const double own = variance_of(strokes[i]);
      const double w = 1 / (own + between);
      pooled_weight += w;
      pooled += w * strokes[i].stiffness_N_m.value;
      within += w * w * own;
      welch += std::pow(w * w * own, 2) / std::max(1.0, freedoms[i]);
    }
    pooled /= pooled_weight;
    within /= pooled_weight * pooled_weight;
    welch /= std::pow(pooled_weight, 4);
    const double variance = 1 / pooled_weight, scatter = std::max(0.0, variance - within);
    if (count > 1) welch += scatter * scatter / (count - 1);

    result_.relative_std_strokes = std::sqrt(variance) / pooled;
    const double relative2 = variance / (pooled * pooled) +
                             std::pow(options_.load_calibration_std, 2) +
                             std::pow(options_.deflection_calibration_std, 2);
    result_.compliance_m_N = {1 / pooled, std::sqrt(relative2) / pooled};
    const double total = relative2 * pooled * pooled;
    result_.degrees_of_freedom = welch > 0 ? total * total / welch : 0;
    if (!(result_.degrees_of_freedom < 1000)) result_.degrees_of_freedom = 0;
  }

  signal::Estimate mean_of(bool loading) const {
    double weight = 0, sum = 0;
    for (const auto& s : result_.strokes) {
      if (s.loading != loading) continue;
      const double w = 1 / variance_of(s);
      weight += w, sum += w * s.stiffness_N_m.value;
    }
    if (weight == 0) return {};
    return {sum / weight, 1 / std::sqrt(weight)};
  }

  void judge_strokes() {
    auto& strokes = result_.strokes;
    result_.loading_stiffness_N_m = mean_of(true);
    result_.unloading_stiffness_N_m = mean_of(false);
    int drops = 0, loadings = 0, unloadings = 0;
    double loading_offset = 0, unloading_offset = 0, toe = 0, top = 0, least = 1;
    double steepest_top = 0;
    double curvature = 0, curvature_std = 0;
    result_.tension_low_N = std::numeric_limits<double>::infinity();
    result_.tension_high_N = 0;
    for (const auto& s : strokes) {
      drops += s.load_drops;
      (s.loading ? loadings : unloadings) += 1;
      (s.loading ? loading_offset : unloading_offset) += s.offset_N;
      const double travel = d_[s.last] - d_[s.first];
      const double before = (d_[s.used_first] - d_[s.first]) / travel;
      const double after = (d_[s.last] - d_[s.used_last]) / travel;
      least = std::min(least, 1 - before - after);
      if (s.loading) {
        toe = std::max(toe, before);
        top = std::max(top, after);
      } else {
        toe = std::max(toe, after);
      }
      // A stop: the load goes on rising where the deflection hardly does.
      const Eigen::Index end = s.loading ? s.last : s.first;
      const Eigen::Index knee = s.loading ? s.used_last : s.used_first;
      const double rise = std::abs(Q_[end] - Q_[knee]), way = std::abs(d_[end] - d_[knee]);
      if (rise > 0.02 * range_Q_) {
        steepest_top =
            std::max(steepest_top, rise / std::max(way, 1e-12 * range_d_) / s.stiffness_N_m.value);
      }
      if (std::abs(s.curvature) > std::abs(curvature)) {
        curvature = s.curvature;
        curvature_std = s.curvature_std;
      }
      for (Eigen::Index i = s.used_first; i <= s.used_last; ++i) {
        result_.tension_low_N = std::min(result_.tension_low_N, P_[i]);
        result_.tension_high_N = std::max(result_.tension_high_N, P_[i]);
      }
    }
    if (loadings > 0 && unloadings > 0) {
      result_.hysteresis_N = 0.5 * (loading_offset / loadings - unloading_offset / unloadings);
    }
    if (toe > options_.turn_share + 0.05) {
      note("toe", fmt::format("the first {:.0f} % of the deflection are a toe (slack or friction "
                              "being taken up) and were left out",
                              100 * toe));
    }
    if (steepest_top > 2) {
      note("stop",
           fmt::format("above the straight part the load rises {:.1f} times as steeply: the "
                       "deflection met a stop or its sensor's end; left out",
                       steepest_top));
    } else if (top > options_.turn_share + 0.05) {
      note("top", fmt::format("the last {:.0f} % of the loading leave the straight line and were "
                              "left out",
                              100 * top));
    }
    if (drops > 0) {
      note("stick_slip", fmt::format("{} sudden losses of load: stick-slip; the robust line passes "
                                     "through what lies between",
                                     drops));
    }
    if (least < options_.least_straight_share) {
      refuse("curved",
             fmt::format("only {:.0f} % of a stroke are straight within {:.1f} % of the load: a "
                         "curved load-deflection diagram has no one EI; load less, or look for "
                         "slip, a stop or loose clamps",
                         100 * std::max(0.0, least), 100 * options_.straightness));
    } else if (std::abs(curvature) > options_.curvature_warning &&
               std::abs(curvature) > 3 * curvature_std) {
      const std::string message =
          fmt::format("the slope changes by {:+.0f} % over the straight part", 100 * curvature);
      if (std::abs(curvature) > options_.curvature_refusal) {
        refuse("curved", message + ": a curved load-deflection diagram has no one EI");
      } else {
        note("curved", message + "; EI is that of its mean slope");
      }
    }
    if (result_.relative_std_strokes > 0.3) {
      refuse("no_slope",
             fmt::format("the slope is uncertain by {:.0f} %: noise, or strokes that do "
                         "not agree",
                         100 * result_.relative_std_strokes));
    }
    const auto status = result_.stiffness.status;
    if (status == BendingStatus::upper_bound_only) {
      note("upper_bound_only", result_.stiffness.reason);
    } else if (status != BendingStatus::solved) {
      refuse(status == BendingStatus::string_like ? "string_like" : "no_EI",
             result_.stiffness.reason);
    }
  }

  BendingTestOptions options_;
  BendingTestResult result_;
  Eigen::VectorXd P_, Q_, d_;
  double range_d_ = 0, range_Q_ = 0, mean_tension_ = 0, zero_ = 0;
  mutable double freedom_ = 0;  // of the stroke fitted last
};

}  // namespace

BendingTestResult analyse_bending_test(const BendingRecord& record,
                                       const BendingTestOptions& options) {
  return Analysis(record, options).run();
}

std::vector<BendingRecord> split_by_tension(const BendingRecord& table) {
  const Eigen::Index n = table.tension_N.size();
  std::vector<Eigen::Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return table.tension_N[a] < table.tension_N[b];  // NaN never compares; such rows stay together
  });
  std::vector<std::vector<Eigen::Index>> clusters;
  for (Eigen::Index index : order) {
    const double P = table.tension_N[index];
    if (!std::isfinite(P)) continue;
    bool apart = clusters.empty();
    if (!apart) {
      const double low = table.tension_N[clusters.back().front()];
      const double high = table.tension_N[clusters.back().back()];
      apart = P - high > 0.05 * std::abs(P) && P - high > high - low;
    }
    if (apart) clusters.emplace_back();
    clusters.back().push_back(index);
  }
  std::vector<BendingRecord> records;
  for (auto& cluster : clusters) {
    std::sort(cluster.begin(), cluster.end());
    BendingRecord record;
    const auto size = static_cast<Eigen::Index>(cluster.size());
    record.tension_N.resize(size), record.load_N.resize(size), record.deflection_m.resize(size);
    for (Eigen::Index i = 0; i < size; ++i) {
      const Eigen::Index row = cluster[static_cast<std::size_t>(i)];
      record.tension_N[i] = table.tension_N[row];
      record.load_N[i] = table.load_N[row];
      record.deflection_m[i] = table.deflection_m[row];
    }
    records.push_back(std::move(record));
  }
  return records;
}

}  // namespace rigfit::ident
