#include "ident/bending/bending_analysis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "ident/bending/beam_segments.h"
#include "ident/bending/bending_strokes.h"
#include "ident/bending/table_line.h"
#include "ident/stiffness/stiffness_law.h"
#include "signal/estimation/groups.h"
#include "signal/estimation/robust.h"

namespace rigfit::ident {
namespace {

/// Strokes of fewer rows are analysed as a table: the noise is not seen from row to row.
constexpr Eigen::Index kShortStroke = 40;
constexpr double kLeastStraight = 0.4;  // share of a stroke's deflection
constexpr const char* kNoStiffness =
    "Load less, cut off the rows of a toe or a stop, or look for slip and loose clamps: a curved "
    "load-deflection diagram has no single EI; ";

/// Rows of a short table that lie off the line of the others by more than half the load's range
/// (of the middle 80 %): they would tear the strokes apart.
std::vector<Eigen::Index> table_spikes(const Eigen::VectorXd& d, const Eigen::VectorXd& Q) {
  std::vector<Eigen::Index> spikes;
  const TableLine line = d.size() < 5 ? TableLine{} : fit_table_line({{true, d, Q}}, 0, 0);
  if (!line.usable) return spikes;
  const double limit = 0.5 * central_range({Q.begin(), Q.end()});
  for (Eigen::Index i = 0; i < d.size(); ++i) {
    const double off = Q[i] - line.offsets_N[0] - line.slope_N_m * d[i];
    if (!line.used[0][static_cast<std::size_t>(i)] && std::abs(off) > limit) spikes.push_back(i);
  }
  return spikes;
}

struct PooledSlope {
  double K = 0, variance = 0;  // N/m
  double welch = 0;            // variance^2 over its degrees of freedom
};

// The mean over strokes with the scatter between them, degrees of freedom after Welch and
// Satterthwaite (GUM G.4). Exact tables have lines without residuals; rounding keeps their variance
// from being zero.
PooledSlope pool_slopes(const std::vector<signal::Estimate>& slopes,
                        const std::vector<double>& freedoms) {
  std::vector<double> values, variances;
  for (const auto& K : slopes) {
    values.push_back(K.value);
    variances.push_back(std::pow(std::max(K.std, 1e-10 * K.value), 2));
  }
  const auto mean = signal::mean_over_groups(values, variances);
  PooledSlope pooled{mean.mean, mean.variance, 0};
  double scatter = mean.variance;  // what the strokes' own variances do not explain
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    const double own = mean.weights[i] * mean.weights[i] * variances[i];
    pooled.welch += own * own / std::max(1.0, freedoms[i]);
    scatter -= own;
  }
  if (slopes.size() > 1 && scatter > 0) {
    pooled.welch += scatter * scatter / static_cast<double>(slopes.size() - 1);
  }
  return pooled;
}

class Analysis {
 public:
  Analysis(const BendingRecord& record, const BendingTestOptions& options) : options_(options) {
    result_.ends = options.ends;
    take_complete_rows(record);
  }

  BendingTestResult run() {
    leave_spikes_out();
    const Eigen::Index n = d_.size();
    if (n < 3) {
      refuse("too_few_points",
             fmt::format("Add rows: {} are complete in tension, load and deflection, 3 are needed",
                         n));
      return finish();
    }
    range_d_ = d_.maxCoeff() - d_.minCoeff();
    range_Q_ = Q_.maxCoeff() - Q_.minCoeff();
    if (!(range_d_ > 0 && range_Q_ > 0)) {
      refuse("no_loading", "Check the load and deflection channels: one of them never changes");
      return finish();
    }
    result_.load_noise_N = options_.load_noise_N > 0 ? options_.load_noise_N : sample_noise(Q_);
    result_.deflection_noise_m =
        options_.deflection_noise_m > 0 ? options_.deflection_noise_m : sample_noise(d_);
    mean_tension_ = P_.mean();
    if (!beam() && !(mean_tension_ > 0)) {
      refuse("no_tension", fmt::format("Check the sign and zero of the tension channel: its mean "
                                       "is {:.4g} N",
                                       mean_tension_));
      return finish();
    }
    // Counted positive both: the deflection along the load, and the load away from zero.
    if (Q_.dot((d_.array() - d_.mean()).matrix()) < 0) d_ = -d_;
    if (-Q_.minCoeff() > Q_.maxCoeff()) Q_ = -Q_, d_ = -d_;

    // Zero of the deflection: the least there is, within its noise.
    const double lowest = d_.minCoeff();
    std::vector<double> unloaded;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (d_[i] <= lowest + 6 * result_.deflection_noise_m) unloaded.push_back(d_[i]);
    }
    zero_ = signal::median(unloaded);

    find_clamp_slip();
    fit_strokes();
    if (!result_.strokes.empty()) {
      survey();
      table_.usable ? judge_table() : judge_strokes();
      judge_slope();
    }
    return finish();
  }

 private:
  /// Without tension.
  [[nodiscard]] bool beam() const { return options_.ends != BeamEnds::tensioned; }

  void take_complete_rows(const BendingRecord& record) {
    const Eigen::Index n = record.load_N.size();
    const Eigen::VectorXd tension = beam() ? Eigen::VectorXd::Zero(n) : record.tension_N;
    if (record.deflection_m.size() != n || tension.size() != n) {
      throw std::invalid_argument("bending test: channels of different lengths");
    }
    if (!(options_.span_m.value > 0)) {
      throw std::invalid_argument("bending test: the span must be positive");
    }
    P_.resize(n), Q_.resize(n), d_.resize(n);
    Eigen::Index kept = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!std::isfinite(tension[i]) || !std::isfinite(record.load_N[i]) ||
          !std::isfinite(record.deflection_m[i])) {
        continue;
      }
      P_[kept] = tension[i];
      Q_[kept] = record.load_N[i];
      d_[kept++] = record.deflection_m[i];
    }
    P_.conservativeResize(kept), Q_.conservativeResize(kept), d_.conservativeResize(kept);
    if (kept < n) {
      note("missing",
           fmt::format("Check the channels for gaps: {} of {} rows miss a value and are left out",
                       n - kept, n));
    }
  }

  void leave_spikes_out() {
    std::vector<Eigen::Index> rows, kept;
    if (d_.size() < kShortStroke) {
      rows = table_spikes(d_, Q_);
    } else {
      for (const Eigen::VectorXd* channel : {&d_, &Q_, &P_}) {
        for (const auto i : find_spikes(*channel)) rows.push_back(i);
      }
    }
    if (rows.empty()) return;
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    note("spike",
         fmt::format("Check row {} ({:.4g} N, {:.4g} m): it is the first of {} with a spike, "
                     "which are left out",
                     rows[0] + 1, Q_[rows[0]], d_[rows[0]], rows.size()));
    for (Eigen::Index i = 0; i < d_.size(); ++i) {
      if (!std::binary_search(rows.begin(), rows.end(), i)) kept.push_back(i);
    }
    P_ = P_(kept).eval(), Q_ = Q_(kept).eval(), d_ = d_(kept).eval();
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
    const double noise = std::max(sample_noise(P_), 0.0);
    double worst = 0;
    for (const StrokeRange& run : find_strokes(d_, least)) {
      if (beam() || run.direction < 0) continue;
      double highest = -std::numeric_limits<double>::infinity();
      for (Eigen::Index i = run.first + 2; i + 2 <= run.last; ++i) {
        const double local = signal::median({P_[i - 2], P_[i - 1], P_[i], P_[i + 1], P_[i + 2]});
        highest = std::max(highest, local);
        worst = std::max(worst, highest - local);
      }
    }
    if (!beam() && worst > std::max(0.02 * mean_tension_, 8 * noise)) {
      const std::string message = fmt::format(
          "the tension fell by {:.3g} N ({:.1f} %) while the cable was being loaded, so a clamp "
          "slipped or the frame gave way",
          worst, 100 * worst / mean_tension_);
      if (worst > 0.1 * mean_tension_) {
        refuse("clamp_slip", "Tighten the clamps and repeat: " + message);
      } else {
        note("clamp_slip", "Check the clamps: " + message + "; the tension is used as measured");
      }
    }
    // Return to zero: load gone, deflection not.
    const double low = Q_.minCoeff() + 0.05 * range_Q_;
    const Eigen::Index n = d_.size();
    if (Q_[0] <= low && Q_[n - 1] <= low) {
      const double set = d_[n - 1] - d_[0];
      if (std::abs(set) > std::max(0.03 * range_d_, 8 * result_.deflection_noise_m)) {
        note("set", fmt::format("Check the clamps for slip: {:.3g} mm of deflection is left after "
                                "unloading ({:.0f} % of the largest), unless the strand settled",
                                1e3 * set, 100 * std::abs(set) / range_d_));
      }
    }
  }

  // g(P): compliance at the mean tension over that at the tension of the moment.
  Eigen::VectorXd tension_corrected(double EI) const {
    if (beam()) return d_.array() - zero_;
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

  void fit_strokes() {
    const double least = std::max(0.2 * range_d_, 6 * result_.deflection_noise_m);
    std::vector<StrokeRange> runs;
    for (const StrokeRange& run : find_strokes(d_, least)) {
      const bool whole = std::abs(d_[run.last] - d_[run.first]) >= 0.5 * range_d_;
      if (whole) runs.push_back(run);
    }
    Eigen::Index longest = 0;
    for (const auto& run : runs) longest = std::max(longest, run.last - run.first + 1);
    if (longest < kShortStroke) {
      if (d_.size() < 2 * kShortStroke || longest >= 4) return fit_table(std::move(runs));
    }
    std::erase_if(runs, [](const StrokeRange& run) { return run.last - run.first + 1 < 4; });
    if (runs.empty()) {
      refuse("no_loading", "Load and unload in strokes of four samples or more: none was found");
      return;
    }
    if (beam()) return fit_elastic_parts(runs);
    if (!fit_straight_parts(runs, kTurnShare)) {
      refuse("no_slope",
             "Check the signs of load and deflection: no stroke has a straight part with a "
             "positive slope");
      return;
    }
    if (loops_open()) {
      const double near_turns = pooled_.K;
      hysteresis_seen_ = true;
      if (!fit_straight_parts(runs, kFrictionShare)) {
        refuse("friction",
               fmt::format("Deflect further: wire friction turns round, and without the first "
                           "{:.0f} % after the turns no stroke has a straight part",
                           100 * kFrictionShare));
        return;
      }
      // What is still left of the transient: nothing by one law of friction, twice the change by
      // another, either as likely.
      const double change = pooled_.K - near_turns;
      pooled_.K += change;
      friction_change_ = std::abs(change) / pooled_.K;
      pooled_.variance += change * change;
      take(pooled_);
      far_end_ = far_end();
    }
    solve_for_EI();
  }

  /// The lines of all strokes without `turn_share` of their travel after each turn, with the EI
  /// that follows; false where no stroke has one.
  bool fit_straight_parts(const std::vector<StrokeRange>& runs, double turn_share) {
    double EI = 0, before = -1;
    for (int pass = 0; pass < 8; ++pass) {
      const Eigen::VectorXd x = tension_corrected(EI);
      result_.strokes.clear();
      std::vector<double> freedoms;
      for (const StrokeRange& run : runs) {
        double freedom = 0;
        BendingStroke stroke = fit_straight_part(
            run, {d_, x, Q_, range_Q_, result_.load_noise_N, result_.deflection_noise_m},
            turn_share, freedom);
        if (!(stroke.stiffness_N_m.value > 0) || !std::isfinite(stroke.stiffness_N_m.std)) continue;
        result_.strokes.push_back(stroke);
        freedoms.push_back(freedom);
      }
      if (result_.strokes.empty()) return false;
      take(pool_strokes(freedoms));
      EI = EI_of_slope();
      if (std::abs(EI - before) <= 1e-7 * EI) break;
      before = EI;
    }
    return true;
  }

  /// Whether loading and unloading lie apart in the middle of the travel by three standard
  /// deviations (of a line's middle: that of its slope times the range over sqrt(12)).
  [[nodiscard]] bool loops_open() const {
    std::vector<double> level[2], variance[2];
    const double middle = 0.5 * range_d_;
    for (const auto& s : result_.strokes) {
      level[s.loading].push_back(s.offset_N + s.stiffness_N_m.value * middle);
      const double range = std::abs(d_[s.used_last] - d_[s.used_first]);
      variance[s.loading].push_back(std::pow(s.stiffness_N_m.std * range, 2) / 12);
    }
    if (level[0].empty() || level[1].empty()) return false;
    const auto mean = [](const std::vector<double>& x) {
      return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
    };
    const double std = std::sqrt(mean(variance[0]) / static_cast<double>(level[0].size()) +
                                 mean(variance[1]) / static_cast<double>(level[1].size()));
    return mean(level[1]) - mean(level[0]) > 3 * std + 1e-6 * range_Q_;
  }

  /// Share of the travel that the straight parts lack at the end away from the turn, on average.
  [[nodiscard]] double far_end() const {
    double sum = 0;
    for (const auto& s : result_.strokes) {
      sum += std::abs(d_[s.last] - d_[s.used_last]) / std::abs(d_[s.last] - d_[s.first]);
    }
    return sum / static_cast<double>(result_.strokes.size());
  }

  /// Strokes of a beam without tension. Where it yielded, or broke, only loading is used.
  void fit_elastic_parts(const std::vector<StrokeRange>& runs) {
    const Eigen::VectorXd x = tension_corrected(0);
    std::vector<double> freedoms;
    bool yielded = false;
    for (const bool loading : {true, false}) {
      for (const StrokeRange& run : runs) {
        if ((run.direction > 0) != loading || (yielded && !loading)) continue;
        ElasticPart part = find_elastic_part(
            run, {d_, x, Q_, range_Q_, result_.load_noise_N, result_.deflection_noise_m});
        for (auto& finding : part.findings) {
          yielded |= finding.code == "yield" || finding.code == "break";
          result_.refused |= finding.refuses;
          result_.findings.push_back(std::move(finding));
        }
        if (!std::isfinite(part.stroke.stiffness_N_m.std)) continue;
        result_.strokes.push_back(part.stroke);
        freedoms.push_back(part.degrees_of_freedom);
      }
    }
    if (result_.strokes.empty()) {
      if (!result_.refused) {
        refuse("no_slope",
               "Check the signs of load and deflection: no stroke has an elastic part with a "
               "positive slope");
      }
      return;
    }
    take(pool_strokes(freedoms));
    solve_for_EI();
  }

  void solve_for_EI() {
    if (beam()) {
      result_.tension_N = {0, 0};
    } else {
      result_.tension_N = {mean_tension_,
                           std::hypot(options_.tension_calibration_std * mean_tension_,
                                      options_.tension_zero_std_N)};
      Eigen::Index first = P_.size(), last = 0;
      for (const auto& stroke : result_.strokes) {
        first = std::min(first, stroke.first), last = std::max(last, stroke.last);
      }
      if (last >= first) {
        result_.tension_spread_N =
            tension_spread(P_.segment(first, last - first + 1), sample_noise(P_));
      }
    }
    result_.stiffness = stiffness_from_compliance({result_.compliance_m_N, result_.tension_N,
                                                   options_.span_m, result_.degrees_of_freedom,
                                                   options_.ends, options_.clamp_stiffness_Nm_rad});
  }

  /// Strokes of few rows (table_line.h).
  void fit_table(std::vector<StrokeRange> runs) {
    Eigen::Index in_runs = 0;
    for (const auto& run : runs) in_runs += run.last - run.first + 1;
    if (10 * in_runs < 7 * d_.size()) {  // weights in any order
      runs = {{0, d_.size() - 1, 1}};
    }
    // Weights that are added at a stop move nothing any more; they belong to the loading.
    for (std::size_t k = 0; k < runs.size(); ++k) {
      Eigen::Index& last = runs[k].last;
      while (runs[k].direction > 0 && last + 1 < d_.size() && d_[last + 1] == d_[last] &&
             Q_[last + 1] > Q_[last]) {
        ++last;
      }
      if (k + 1 < runs.size()) runs[k + 1].first = std::max(runs[k + 1].first, last);
    }
    const double digits =
        std::hypot(resolution_of(Q_, 1), resolution_of(d_, 1) * range_Q_ / range_d_);
    double EI = 0, before = -1;
    for (int pass = 0; pass < 8; ++pass) {
      const Eigen::VectorXd x = tension_corrected(EI);
      std::vector<TableStroke> strokes;
      for (std::size_t k = 0; k < runs.size(); ++k) {
        // The row of a turn belongs to the stroke before.
        const Eigen::Index first = runs[k].first + (k > 0 && runs[k].first == runs[k - 1].last);
        const Eigen::Index n = runs[k].last - first + 1;
        TableStroke stroke;
        stroke.loading = runs[k].direction > 0;
        stroke.x_m = x.segment(first, n), stroke.load_N = Q_.segment(first, n);
        strokes.push_back(std::move(stroke));
      }
      const double stated =
          std::hypot(options_.load_noise_N, options_.deflection_noise_m * range_Q_ / range_d_);
      table_ = fit_table_line(strokes, digits / std::sqrt(12.0), stated);
      if (!table_.usable) {
        refuse("no_slope", fmt::format("Add rows: {} give no rising line of load over deflection "
                                       "with a scatter that can be seen",
                                       d_.size()));
        return;
      }
      take_table(runs);
      EI = EI_of_slope();
      if (std::abs(EI - before) <= 1e-7 * EI) break;
      before = EI;
    }
    solve_for_EI();
  }

  void take_table(const std::vector<StrokeRange>& runs) {
    result_.strokes.clear();
    result_.load_noise_N = table_.noise_N;
    std::vector<signal::Estimate> slopes;
    for (std::size_t k = 0; k < runs.size(); ++k) {
      BendingStroke stroke;
      stroke.loading = runs[k].direction > 0;
      stroke.first = runs[k].first, stroke.last = runs[k].last;
      const auto& used = table_.used[k];
      const auto rows = static_cast<Eigen::Index>(used.size());
      const Eigen::Index first = stroke.last - rows + 1;
      const auto begin = std::find(used.begin(), used.end(), 1);
      const auto end = std::find(used.rbegin(), used.rend(), 1);
      if (begin == used.end() || !std::isfinite(table_.stroke_slopes[k].value)) continue;
      stroke.used_first = first + (begin - used.begin());
      stroke.used_last = stroke.last - (end - used.rbegin());
      stroke.stiffness_N_m = table_.stroke_slopes[k];
      stroke.offset_N = table_.offsets_N[k];
      stroke.residual_rms_N = table_.residual_N;
      stroke.curvature = table_.curvature;
      result_.strokes.push_back(stroke);
      slopes.push_back(stroke.stiffness_N_m);
    }
    PooledSlope pooled;
    pooled.K = table_.slope_N_m;
    pooled.variance = std::pow(std::max(table_.slope_std_N_m, 1e-10 * pooled.K), 2);
    pooled.welch = pooled.variance * pooled.variance / table_.degrees_of_freedom;
    if (table_.strokes_differ) {
      const PooledSlope apart =
          pool_slopes(slopes, std::vector<double>(slopes.size(), table_.degrees_of_freedom));
      if (apart.variance > pooled.variance) pooled = apart;
    }
    pooled.variance += std::pow(table_.friction_std_N_m, 2);
    take(pooled);
  }

  /// What lies before and after the straight parts, and between loading and unloading.
  void survey() {
    double loadings = 0, unloadings = 0, loading_offset = 0, unloading_offset = 0;
    result_.tension_low_N = std::numeric_limits<double>::infinity();
    for (const auto& s : result_.strokes) {
      (s.loading ? loadings : unloadings) += 1;
      (s.loading ? loading_offset : unloading_offset) += s.offset_N;
      const double travel = d_[s.last] - d_[s.first];
      const double before = (d_[s.used_first] - d_[s.first]) / travel;
      const double after = (d_[s.last] - d_[s.used_last]) / travel;
      least_straight_ = std::min(least_straight_, 1 - before - after);
      toe_ = std::max(toe_, s.loading ? before : after);
      if (s.loading) top_ = std::max(top_, after);
      // A stop: the load goes on rising where the deflection hardly does.
      const Eigen::Index end = s.loading ? s.last : s.first;
      const Eigen::Index knee = s.loading ? s.used_last : s.used_first;
      const double rise = std::abs(Q_[end] - Q_[knee]), way = std::abs(d_[end] - d_[knee]);
      if (rise > 0.02 * range_Q_) {
        steepest_ =
            std::max(steepest_, rise / std::max(way, 1e-12 * range_d_) / s.stiffness_N_m.value);
      }
      if (std::abs(s.curvature) > std::abs(curvature_.value)) {
        curvature_ = {s.curvature, s.curvature_std};
      }
      const auto used = P_.segment(s.used_first, s.used_last - s.used_first + 1);
      result_.tension_low_N = std::min(result_.tension_low_N, used.minCoeff());
      result_.tension_high_N = std::max(result_.tension_high_N, used.maxCoeff());
    }
    result_.hysteresis_N = table_.usable ? table_.hysteresis_N
                           : loadings > 0 && unloadings > 0
                               ? 0.5 * (loading_offset / loadings - unloading_offset / unloadings)
                               : 0;
  }

  static std::string friction_message(double hysteresis) {
    return fmt::format(
        "loading and unloading lie {:.2g} N apart by wire friction, which stiffens "
        "the strand after every turn; the rows after the turns are left out, and "
        "the change by this adds to the uncertainty",
        2 * hysteresis);
  }
  /// Share of the travel left out after each turn.
  [[nodiscard]] double turn_share() const { return hysteresis_seen_ ? kFrictionShare : kTurnShare; }

  void judge_strokes() {
    const bool tensioned = !beam();
    if (friction_change_ > kFrictionRefusal) {
      refuse(
          "friction",
          fmt::format("Deflect further: wire friction turns round over much of a stroke; without "
                      "the first {:.0f} % after the turns the slope changes by {:.1f} %",
                      100 * kFrictionShare, 100 * friction_change_));
    } else if (far_end_ > kFrictionFarEnd) {
      refuse("friction",
             fmt::format("Deflect further, or less where there is a stop: loading and unloading "
                         "lie apart, and the slope is another one over the last {:.0f} % of the "
                         "strokes, so that friction may still be turning round before",
                         100 * far_end_));
    } else if (friction_change_ > 1e-3) {
      note("friction", friction_message(result_.hysteresis_N));
    } else if (tensioned && toe_ > turn_share() + 0.05) {
      note("toe",
           fmt::format("the first {:.0f} % of the deflection are left out as a toe (slack or "
                       "friction being taken up)",
                       100 * toe_));
    }
    if (tensioned && (steepest_ > 2 || top_ > turn_share() + 0.05)) {
      note("stop",
           fmt::format("Deflect less, or check for a stop or a sensor's end: the last {:.0f} % "
                       "of the loading leave the straight line (slope {:.1f} times as "
                       "steep) and are left out",
                       100 * top_, steepest_));
    }
    if (tensioned && least_straight_ < kLeastStraight) {
      return refuse("curved", fmt::format("{}only {:.0f} % of a stroke is straight within {:.1f} % "
                                          "of the load",
                                          kNoStiffness, 100 * std::max(0.0, least_straight_),
                                          100 * kStraight));
    }
    if (std::abs(curvature_.value) > 3 * curvature_.std) judge_curvature(curvature_.value);
  }

  void judge_curvature(double curvature) {
    if (!(std::abs(curvature) > kCurvatureWarning)) return;
    const std::string message =
        fmt::format("the slope changes by {:+.0f} % over the straight part", 100 * curvature);
    if (std::abs(curvature) > kCurvatureRefusal) {
      refuse("curved", kNoStiffness + message);
    } else {
      note("curved",
           "Look for slip, a toe or a stop: " + message + "; EI is that of its mean slope");
    }
  }

  void judge_table() {
    const TableLine& t = table_;
    if (t.too_many_off) {
      refuse("curved", std::string(kNoStiffness) +
                           "more than one row in four lie off the line of the others");
    }
    if (t.left_out > 0) {
      note("spike",
           fmt::format(
               "Check for a stop, a toe or a misreading: {} {} off the line of the others and "
               "left out",
               t.left_out, t.left_out == 1 ? "row lies" : "rows lie"));
    }
    if (t.hysteresis_N > 0) {
      note("friction", friction_message(t.hysteresis_N));
    }
    if (t.strokes_differ) {
      note("strokes_differ",
           "Repeat the strokes, or check the clamps: their slopes differ by more than their noise "
           "(5 %), and this scatter widens the interval of EI");
    }
    if (t.curved) {
      judge_curvature(t.curvature);
    } else if (t.curvature_half > kCurvatureRefusal) {
      note("straightness_unknown",
           fmt::format("Add rows: too few or too scattered to show whether the diagram is straight "
                       "(its slope may change by {:.0f} % unseen)",
                       100 * std::min(10.0, std::abs(t.curvature) + t.curvature_half)));
    }
  }

  void judge_slope() {
    const double relative = result_.compliance_m_N.std / result_.compliance_m_N.value;
    if (relative > 0.3) {
      refuse("no_slope", fmt::format("Load further, or repeat: noise or strokes that do not agree "
                                     "make the slope uncertain by {:.0f} %",
                                     100 * relative));
    }
    const auto status = result_.stiffness.status;
    if (status == BendingStatus::upper_bound_only) {
      note("upper_bound_only", result_.stiffness.reason);
    } else if (status != BendingStatus::solved) {
      refuse(status == BendingStatus::string_like ? "string_like" : "no_EI",
             result_.stiffness.reason);
    }
  }

  // 0 for what is softer than a string: its changing tension is then that of a string.
  double EI_of_slope() const {
    if (beam()) return 0;
    const double ratio = 4 * mean_tension_ * result_.compliance_m_N.value / options_.span_m.value;
    if (!(ratio > 0 && ratio < 1)) return 0;
    const double lambda = lambda_from_bending_ratio(ratio);
    return mean_tension_ * std::pow(options_.span_m.value / lambda, 2) / 4;
  }

  PooledSlope pool_strokes(const std::vector<double>& freedoms) {
    std::vector<signal::Estimate> slopes;
    for (const auto& stroke : result_.strokes) slopes.push_back(stroke.stiffness_N_m);
    return pooled_ = pool_slopes(slopes, freedoms);
  }

  void take(const PooledSlope& pooled) {
    const double relative2 = pooled.variance / (pooled.K * pooled.K) +
                             std::pow(options_.load_calibration_std, 2) +
                             std::pow(options_.deflection_calibration_std, 2);
    result_.compliance_m_N = {1 / pooled.K, std::sqrt(relative2) / pooled.K};
    const double total = relative2 * pooled.K * pooled.K;
    result_.degrees_of_freedom = pooled.welch > 0 ? total * total / pooled.welch : 0;
    if (!(result_.degrees_of_freedom < 1000)) result_.degrees_of_freedom = 0;
  }

  BendingTestOptions options_;
  BendingTestResult result_;
  Eigen::VectorXd P_, Q_, d_;
  PooledSlope pooled_;
  bool hysteresis_seen_ = false;
  double far_end_ = 0;          // share of the strokes' travel beyond their straight parts
  double friction_change_ = 0;  // of K, relative: what leaving more of the turns out changes
  TableLine table_;             // line through strokes of few rows
  double range_d_ = 0, range_Q_ = 0, mean_tension_ = 0, zero_ = 0;
  // Extremes over all strokes: shares of the travel left out, the slope beyond the straight part
  // relative to it, the largest curvature.
  double toe_ = 0, top_ = 0, least_straight_ = 1, steepest_ = 0;
  signal::Estimate curvature_{0, 0};
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
