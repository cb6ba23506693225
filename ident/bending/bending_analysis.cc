#include "ident/bending/bending_analysis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "ident/bending/beam_segments.h"
#include "ident/bending/bending_judgement.h"
#include "ident/bending/bending_pooling.h"
#include "ident/bending/bending_spikes.h"
#include "ident/bending/bending_strokes.h"
#include "ident/bending/friction_transient.h"
#include "ident/bending/table_line.h"
#include "ident/stiffness/tension_spread.h"
#include "signal/estimation/robust.h"

namespace rigfit::ident {
namespace {

/// Strokes of fewer rows are analysed as a table: the noise is not seen from row to row.
constexpr Eigen::Index kShortStroke = 40;

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
    if (!beam() && !(mean_tension_ > 0)) {
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
    if (!result_.strokes.empty()) {
      judge_bending({P_, Q_, d_, range_d_, range_Q_}, table_, options_, result_);
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
      refuse("no_loading", "no loading or unloading stroke of four samples or more was found");
      return;
    }
    if (beam()) return fit_elastic_parts(runs);
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
      if (!take_friction(tension_corrected(EI))) break;
      EI = EI_of_slope();
    }
    solve_for_EI();
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
            run, {d_, x, Q_, range_Q_, result_.load_noise_N, result_.deflection_noise_m}, options_);
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
               "no stroke has an elastic part with a positive slope of load over "
               "deflection");
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
    result_.stiffness =
        stiffness_from_compliance({result_.compliance_m_N, result_.tension_N, options_.span_m,
                                   result_.degrees_of_freedom, options_.ends});
  }

  /// Strokes of few rows: nothing is left out before an F-test says so (table_line.h).
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

  // 0 for what is softer than a string: its changing tension is then that of a string.
  double EI_of_slope() const {
    if (beam()) return 0;
    const double ratio = 4 * mean_tension_ * result_.compliance_m_N.value / options_.span_m.value;
    if (!(ratio > 0 && ratio < 1)) return 0;
    const double lambda = lambda_from_bending_ratio(ratio).lambda;
    return mean_tension_ * std::pow(options_.span_m.value / lambda, 2) / 4;
  }

  // The slope averaged over what friction may do after the turns. False when the strokes are too
  // short to tell.
  bool take_friction(const Eigen::VectorXd& x) {
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
    const auto averaged = average_over_friction(strokes, straight_, result_.deflection_noise_m);
    if (!averaged) return false;
    result_.friction_probability = averaged->probability;
    result_.friction_travel_m = averaged->travel_m;
    result_.friction_load_N = averaged->load_N;
    result_.relative_std_friction = averaged->relative_std;
    result_.relative_friction_correction = averaged->relative_correction;
    take(averaged->pooled);
    return true;
  }

  PooledSlope pool_strokes(const std::vector<double>& freedoms) {
    std::vector<signal::Estimate> slopes;
    for (const auto& stroke : result_.strokes) slopes.push_back(stroke.stiffness_N_m);
    return straight_ = pool_slopes(slopes, freedoms);
  }

  void take(const PooledSlope& pooled) {
    result_.relative_std_strokes = std::sqrt(pooled.variance) / pooled.K;
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
  PooledSlope straight_;  // by the straight parts alone
  TableLine table_;       // of strokes of few rows
  double range_d_ = 0, range_Q_ = 0, mean_tension_ = 0, zero_ = 0;
};

}  // namespace

BendingTestResult analyse_bending_test(const BendingRecord& record,
                                       const BendingTestOptions& options) {
  return Analysis(record, options).run();
}

}  // namespace rigfit::ident
