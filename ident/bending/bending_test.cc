#include "ident/bending/bending_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "ident/bending/bending_spikes.h"
#include "ident/bending/bending_strokes.h"
#include "ident/bending/friction_transient.h"
#include "ident/bending/table_line.h"
#include "signal/numerics/robust.h"

namespace rigfit::ident {
namespace {

// Exact tables have lines without residuals; rounding keeps their variance from being zero.
double variance_of(const signal::Estimate& slope) {
  const double std = std::max(slope.std, 1e-10 * slope.value);
  return std * std;
}

/// Strokes of fewer rows are analysed as a table: the noise is not seen from row to row.
constexpr Eigen::Index kShortStroke = 40;

class Analysis {
 public:
  Analysis(const BendingRecord& record, const BendingTestOptions& options) : options_(options) {
    take_complete_rows(record);
  }

  BendingTestResult run() {
    leave_spikes_out();
    const Eigen::Index n = d_.size();
    if (n < 3) {
      refuse("too_few_points",
             fmt::format("{} complete rows of tension, load and deflection; at least 3 are needed",
                         n));
      return finish();
    }
    range_d_ = d_.maxCoeff() - d_.minCoeff();
    range_Q_ = Q_.maxCoeff() - Q_.minCoeff();
    if (!(range_d_ > 0 && range_Q_ > 0)) {
      refuse("no_loading", "load or deflection never changes: nothing was loaded");
      return finish();
    }
    result_.load_noise_N = options_.load_noise_N > 0 ? options_.load_noise_N : sample_noise(Q_);
    result_.deflection_noise_m =
        options_.deflection_noise_m > 0 ? options_.deflection_noise_m : sample_noise(d_);
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
    zero_ = signal::median(unloaded);

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

  void leave_spikes_out() {
    const bool table = d_.size() < kShortStroke;
    std::vector<std::pair<Eigen::Index, std::string>> rows;
    if (table) {
      for (const auto i : find_table_spikes(d_, Q_)) rows.emplace_back(i, "load or deflection");
    } else {
      for (const auto& [channel, name] :
           {std::pair{&d_, "deflection"}, {&Q_, "load"}, {&P_, "tension"}}) {
        for (const auto i : find_spikes(*channel)) rows.emplace_back(i, name);
      }
    }
    if (rows.empty()) return;
    std::sort(rows.begin(), rows.end());
    const auto& [first, channel] = rows.front();
    const std::string where =
        fmt::format("row {} ({} {:.4g} N, {:.4g} m)", first + 1, channel, Q_[first], d_[first]);
    std::vector<Eigen::Index> kept;
    std::size_t at = 0;
    for (Eigen::Index i = 0; i < d_.size(); ++i) {
      while (at < rows.size() && rows[at].first < i) ++at;
      if (at == rows.size() || rows[at].first != i) kept.push_back(i);
    }
    const auto left_out = d_.size() - static_cast<Eigen::Index>(kept.size());
    P_ = P_(kept).eval(), Q_ = Q_(kept).eval(), d_ = d_(kept).eval();
    note("spike",
         fmt::format("{} rows hold a spike and were left out, the first: {}", left_out, where));
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
      if (run.direction < 0) continue;
      double highest = -std::numeric_limits<double>::infinity();
      for (Eigen::Index i = run.first + 2; i + 2 <= run.last; ++i) {
        const double local = signal::median({P_[i - 2], P_[i - 1], P_[i], P_[i + 1], P_[i + 2]});
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
      refuse("no_loading", "no loading or unloading stroke of four samples or more was found");
      return;
    }
    double EI = 0, before = -1;
    for (int pass = 0; pass < 8; ++pass) {
      const Eigen::VectorXd x = tension_corrected(EI);
      result_.strokes.clear();
      std::vector<double> freedoms;
      for (const StrokeRange& run : runs) {
        double freedom = 0;
        BendingStroke stroke = fit_straight_part(
            run, {d_, x, Q_, range_Q_, result_.load_noise_N, result_.deflection_noise_m}, options_,
            freedom);
        if (!(stroke.stiffness_N_m.value > 0) || !std::isfinite(stroke.stiffness_N_m.std)) continue;
        result_.strokes.push_back(stroke);
        freedoms.push_back(freedom);
      }
      if (result_.strokes.empty()) {
        refuse("no_slope",
               "no stroke has a straight part with a positive slope of load over "
               "deflection");
        return;
      }
      take(pool_strokes(freedoms));
      EI = EI_of_slope();
      if (std::abs(EI - before) <= 1e-7 * EI) break;
      before = EI;
    }
    for (int pass = 0; pass < 2; ++pass) {
      if (!take_friction(tension_corrected(EI), straight_)) break;
      EI = EI_of_slope();
    }
    solve_for_EI();
  }

  void solve_for_EI() {
    result_.tension_N = {mean_tension_, std::hypot(options_.tension_calibration_std * mean_tension_,
                                                   options_.tension_zero_std_N)};
    result_.stiffness = stiffness_from_compliance(
        {result_.compliance_m_N, result_.tension_N, options_.span_m, result_.degrees_of_freedom});
  }

  /// Strokes of few rows: nothing is left out before an F-test says so (table_line.h).
  void fit_table(std::vector<StrokeRange> runs) {
    Eigen::Index in_runs = 0;
    for (const auto& run : runs) in_runs += run.last - run.first + 1;
    if (10 * in_runs < 7 * d_.size()) {  // weights in any order
      runs = {{0, d_.size() - 1, 1}};
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
        refuse("no_slope", fmt::format("{} rows give no line of load over deflection that rises "
                                       "and whose scatter shows; add rows",
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
    Pooled pooled;
    pooled.K = table_.slope_N_m;
    pooled.variance = std::pow(std::max(table_.slope_std_N_m, 1e-10 * pooled.K), 2);
    pooled.welch = pooled.variance * pooled.variance / table_.degrees_of_freedom;
    if (table_.strokes_differ) {
      const Pooled apart =
          pool(slopes, std::vector<double>(slopes.size(), table_.degrees_of_freedom));
      if (apart.variance > pooled.variance) pooled = apart;
    }
    pooled.variance += std::pow(table_.friction_std_N_m, 2);
    take(pooled);
  }

  void judge_table() {
    const auto& t = table_;
    const auto rows = [](std::size_t n) {
      return n == 1 ? std::string("1 row") : fmt::format("{} rows", n);
    };
    result_.hysteresis_N = t.hysteresis_N;
    if (!t.spikes.empty()) {
      note("spike", fmt::format("{} far off the line left out", rows(t.spikes.size())));
    }
    if (t.toe_share > 0) {
      note("toe", fmt::format("the first {:.0f} % of the deflection are a toe (F-test) and were "
                              "left out",
                              100 * t.toe_share));
    }
    if (t.top_share > 0) {
      note("top",
           fmt::format("the last {:.0f} % of the deflection leave the straight line (F-test) "
                       "and were left out",
                       100 * t.top_share));
    }
    if (t.hysteresis_N > 0) {
      note("friction", fmt::format("loading and unloading lie {:.2g} N apart: wire friction, which "
                                   "stiffens the strand after every turn; the rows after the turns "
                                   "are left out and what that changes is uncertainty",
                                   2 * t.hysteresis_N));
    }
    if (t.strokes_differ) {
      note("strokes_differ",
           "the slopes of the strokes differ by more than their noise (5 %): "
           "their scatter is in the uncertainty");
    }
    if (t.curved) {
      const std::string message =
          fmt::format("the slope changes by {:+.0f} % over the table (F-test)", 100 * t.curvature);
      if (std::abs(t.curvature) > options_.curvature_refusal) {
        refuse("curved", message +
                             ": a curved load-deflection diagram has no one EI; load less, or "
                             "look for slip, a stop or loose clamps");
      } else if (std::abs(t.curvature) > options_.curvature_warning) {
        note("curved", message + "; EI is that of its mean slope");
      }
    } else if (t.curvature_half > options_.curvature_refusal) {
      note("straightness_unknown",
           std::isfinite(t.curvature_half)
               ? fmt::format("the rows are too few or too scattered to show whether the diagram is "
                             "straight: its slope may change by {:.0f} % unseen",
                             100 * (std::abs(t.curvature) + t.curvature_half))
               : std::string("the rows are too few to show whether the diagram is straight"));
    }
  }

  // 0 for what is softer than a string: its changing tension is then that of a string.
  double EI_of_slope() const {
    const double ratio = 4 * mean_tension_ * result_.compliance_m_N.value / options_.span_m.value;
    if (!(ratio > 0 && ratio < 1)) return 0;
    const double lambda = lambda_from_bending_ratio(ratio).lambda;
    return mean_tension_ * std::pow(options_.span_m.value / lambda, 2) / 4;
  }

  // Slope of all strokes together.
  struct Pooled {
    double K = 0, variance = 0;
    double welch = 0;  // variance^2 over its degrees of freedom
  };

  static Pooled pool(const std::vector<signal::Estimate>& slopes,
                     const std::vector<double>& freedoms) {
    const auto count = static_cast<double>(slopes.size());
    double weight = 0, weight2 = 0, mean = 0;
    for (const auto& K : slopes) {
      const double w = 1 / variance_of(K);
      weight += w, weight2 += w * w, mean += w * K.value;
    }
    mean /= weight;
    double chi = 0;
    for (const auto& K : slopes) chi += std::pow(K.value - mean, 2) / variance_of(K);
    // Variance between strokes beyond what their own lines promise.
    const double between =
        count > 1 ? std::max(0.0, (chi - (count - 1)) / (weight - weight2 / weight)) : 0;
    Pooled pooled;
    double pooled_weight = 0, within = 0;
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      const double own = variance_of(slopes[i]);
      const double w = 1 / (own + between);
      pooled_weight += w;
      pooled.K += w * slopes[i].value;
      within += w * w * own;
      pooled.welch += std::pow(w * w * own, 2) / std::max(1.0, freedoms[i]);
    }
    pooled.K /= pooled_weight;
    within /= pooled_weight * pooled_weight;
    pooled.welch /= std::pow(pooled_weight, 4);
    pooled.variance = 1 / pooled_weight;
    const double scatter = std::max(0.0, pooled.variance - within);
    if (count > 1) pooled.welch += scatter * scatter / (count - 1);
    return pooled;
  }

  Pooled pool_strokes(const std::vector<double>& freedoms) {
    std::vector<signal::Estimate> slopes;
    for (const auto& stroke : result_.strokes) slopes.push_back(stroke.stiffness_N_m);
    return straight_ = pool(slopes, freedoms);
  }

  void take(const Pooled& pooled) {
    result_.relative_std_strokes = std::sqrt(pooled.variance) / pooled.K;
    const double relative2 = pooled.variance / (pooled.K * pooled.K) +
                             std::pow(options_.load_calibration_std, 2) +
                             std::pow(options_.deflection_calibration_std, 2);
    result_.compliance_m_N = {1 / pooled.K, std::sqrt(relative2) / pooled.K};
    const double total = relative2 * pooled.K * pooled.K;
    result_.degrees_of_freedom = pooled.welch > 0 ? total * total / pooled.welch : 0;
    if (!(result_.degrees_of_freedom < 1000)) result_.degrees_of_freedom = 0;
  }

  // The slope averaged over what friction may do after the turns (friction_transient.h). False when
  // the strokes are too short to tell.
  bool take_friction(const Eigen::VectorXd& x, const Pooled& straight) {
    std::vector<FrictionStroke> strokes;
    for (const auto& s : result_.strokes) {
      if (s.last - s.first + 1 < 40) return false;
      // What lies beyond the straight part at the far end is a stop or a toe, no friction.
      const double travel = std::abs(d_[s.last] - d_[s.first]);
      Eigen::Index first = s.first;
      while (first < s.used_first && std::abs(d_[first] - d_[s.first]) < 0.01 * travel) ++first;
      const Eigen::Index n = s.used_last - first + 1;
      FrictionStroke stroke;
      stroke.sign = s.loading ? 1 : -1;
      stroke.travel_m = (d_.segment(first, n).array() - d_[s.first]).abs();
      stroke.x_m = x.segment(first, n);
      stroke.load_N = Q_.segment(first, n);
      strokes.push_back(std::move(stroke));
    }
    struct FrictionCandidate {
      Pooled pooled;
      FrictionFit fit;
    };
    std::vector<FrictionCandidate> candidates;
    double least = std::numeric_limits<double>::infinity();
    for (const FrictionLaw law : kFrictionLaws) {
      FrictionCandidate one;
      one.fit = fit_friction(strokes, law, result_.deflection_noise_m);
      if (!one.fit.usable) return false;
      one.pooled = pool(one.fit.stiffness_N_m,
                        std::vector<double>(strokes.size(), one.fit.degrees_of_freedom));
      if (law == FrictionLaw::none) {
        // Where nothing happens after the turns the line through the straight part is the best
        // there is: it is robust to toes and stops. Its residuals hardly show a drift.
        if (straight.variance > one.pooled.variance) {
          one.pooled = straight;
        } else {
          one.pooled.K = straight.K;
        }
      } else {
        double common = 0;
        for (double by : one.fit.by_travel) common += by / static_cast<double>(strokes.size());
        one.pooled.variance += common * common;
      }
      least = std::min(least, one.fit.aicc);
      candidates.push_back(std::move(one));
    }
    double weight = 0, K = 0, travel = 0, load = 0, none = 0;
    for (const auto& one : candidates) {
      const double w = std::exp(-0.5 * (one.fit.aicc - least));
      weight += w;
      K += w * one.pooled.K;
      if (one.fit.law == FrictionLaw::none) {
        none = w;
        continue;
      }
      travel += w * one.fit.travel_m;
      for (double a : one.fit.load_N) load += w * 0.5 * a / static_cast<double>(strokes.size());
    }
    K /= weight;
    Pooled averaged;
    averaged.K = K;
    double spread = 0, welch = 0;
    for (const auto& one : candidates) {
      const double w = std::exp(-0.5 * (one.fit.aicc - least)) / weight;
      averaged.variance += w * (one.pooled.variance + std::pow(one.pooled.K - K, 2));
      spread += w * std::pow(one.pooled.K - K, 2);
      welch += w * one.pooled.welch / std::pow(one.pooled.variance, 2);
    }
    averaged.welch = welch * averaged.variance * averaged.variance;
    if (!(K > 0) || !std::isfinite(averaged.variance)) return false;
    const double share = 1 - none / weight;
    result_.friction_probability = share;
    result_.friction_travel_m = share > 0.5 ? travel / (weight - none) : 0;
    result_.friction_load_N = share > 0.5 ? load / (weight - none) : 0;
    result_.relative_std_friction = std::sqrt(spread) / K;
    result_.relative_friction_correction = K / straight.K - 1;
    take(averaged);
    return true;
  }

  signal::Estimate mean_of(bool loading) const {
    double weight = 0, sum = 0;
    for (const auto& s : result_.strokes) {
      if (s.loading != loading) continue;
      const double w = 1 / variance_of(s.stiffness_N_m);
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
    if (table_.usable) {
      judge_table();
      return judge_slope();
    }
    if (loadings > 0 && unloadings > 0) {
      result_.hysteresis_N = 0.5 * (loading_offset / loadings - unloading_offset / unloadings);
    }
    if (result_.friction_probability > 0.5 &&
        std::abs(result_.relative_friction_correction) > 1e-3) {
      note(
          "friction",
          fmt::format("wire friction stiffens the first {:.2g} mm after every turn (by {:.2g} N in "
                      "all); without it the slope is {:+.1f} % of a straight line's",
                      1e3 * result_.friction_travel_m, 2 * result_.friction_load_N,
                      100 * result_.relative_friction_correction));
    } else if (toe > options_.turn_share + 0.05) {
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
      if (result_.friction_probability > 0.9 &&
          std::abs(curvature) > 2 * options_.curvature_warning) {
        refuse("friction",
               message +
                   " although wire friction after the turns is taken out: it turns round "
                   "over most of a stroke, and no slope is free of it; deflect further");
      } else if (std::abs(curvature) > options_.curvature_refusal) {
        refuse("curved", message + ": a curved load-deflection diagram has no one EI");
      } else {
        note("curved", message + "; EI is that of its mean slope");
      }
    }
    judge_slope();
  }

  void judge_slope() {
    if (result_.compliance_m_N.std / result_.compliance_m_N.value > 0.3) {
      refuse("no_slope",
             fmt::format("the slope is uncertain by {:.0f} %: noise, or strokes that do "
                         "not agree",
                         100 * result_.compliance_m_N.std / result_.compliance_m_N.value));
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
  Pooled straight_;  // by the straight parts alone
  TableLine table_;  // of strokes of few rows
  double range_d_ = 0, range_Q_ = 0, mean_tension_ = 0, zero_ = 0;
};

}  // namespace

BendingTestResult analyse_bending_test(const BendingRecord& record,
                                       const BendingTestOptions& options) {
  return Analysis(record, options).run();
}

}  // namespace rigfit::ident
