#include "ident/bending/bending_analysis.h"

#include <fmt/format.h>

#include <numeric>

#include "ident/bending/table_line.h"
#include "ident/stiffness/stiffness_law.h"
#include "signal/estimation/robust.h"

namespace rigfit::ident {
namespace {

constexpr double kLeastStraight = 0.4;  // share of a stroke's travel or load
constexpr double kScatterSaid = 0.01;   // std of the slope by strokes that differ, relative
// Strokes up and down: this share of the travel after a turn, where friction first changes sign, is
// not used.
constexpr double kTurnShare = 0.15;
constexpr double kEndSaid = 0.15;  // share of the travel before or beyond, from which it is named
// An average that leaves the straight line by more than this share of the load range (and four
// times its noise) belongs to a toe, yield or a stop.
constexpr double kStraight = 0.005;
// Relative change of slope over the straight part: above the first it is warned of, above the
// second there is no one EI.
constexpr double kCurvatureWarning = 0.05, kCurvatureRefusal = 0.25;
constexpr const char* kNoStiffness =
    "Load less, cut off the rows of a toe or a stop, or look for slip and loose clamps: a curved "
    "load-deflection diagram has no single EI; ";

class Analysis {
 public:
  Analysis(const BendingRecord& record, const BendingTestOptions& options) : options_(options) {
    result_.ends = options.ends;
    take_complete_rows(record);
  }

  BendingTestResult run() {
    leave_spikes_out();
    const Index n = d_.size();
    if (n < 3) {
      refuse("too_few_points",
             "Add rows: {} are complete in tension, load and deflection, 3 are needed", n);
      return finish();
    }
    range_d_ = d_.maxCoeff() - d_.minCoeff();
    range_Q_ = Q_.maxCoeff() - Q_.minCoeff();
    if (!(range_d_ > 0 && range_Q_ > 0)) {
      refuse("no_loading", "Check the load and deflection channels: one of them never changes");
      return finish();
    }
    load_noise_ = sample_noise(Q_);
    deflection_noise_ = sample_noise(d_);
    mean_tension_ = P_.mean();
    if (!beam() && !(mean_tension_ > 0)) {
      refuse("no_tension", "Check the sign and zero of the tension channel: its mean is {:.4g} N",
             mean_tension_);
      return finish();
    }
    // Counted positive both: the deflection along the load, and the load away from zero.
    if (Q_.dot((d_.array() - d_.mean()).matrix()) < 0) d_ = -d_;
    if (-Q_.minCoeff() > Q_.maxCoeff()) Q_ = -Q_, d_ = -d_;

    find_zero();
    runs_ = find_strokes(d_, std::max(0.2 * range_d_, 6 * deflection_noise_));
    find_clamp_slip();
    if (fit_strokes()) {
      solve_for_EI();
      judge_line();
      judge_slope();
    }
    return finish();
  }

 private:
  /// Without tension.
  [[nodiscard]] bool beam() const { return options_.ends != BeamEnds::tensioned; }

  void take_complete_rows(const BendingRecord& record) {
    const Index n = record.load_N.size();
    Q_ = record.load_N, d_ = record.deflection_m, P_ = record.tension_N;
    if (beam()) P_.setZero(n);
    if (d_.size() != n || P_.size() != n) {
      throw std::invalid_argument("bending test: channels of different lengths");
    }
    if (!(options_.span_m.value > 0)) {
      throw std::invalid_argument("bending test: the span must be positive");
    }
    keep([&](Index i) { return std::isfinite(P_[i] + Q_[i] + d_[i]); });
    if (d_.size() < n) {
      note("missing", "Check the channels for gaps: {} of {} rows miss a value and are left out",
           n - d_.size(), n);
    }
  }

  void leave_spikes_out() {
    std::set<Index> rows;
    if (d_.size() < kShortStroke) return;  // rows off the line are left out
    for (const VectorXd* channel : {&d_, &Q_, &P_}) {
      for (const auto i : find_spikes(*channel)) rows.insert(i);
    }
    if (rows.empty()) return;
    const Index first = *rows.begin();
    note(
        "spike",
        "Check row {} ({:.4g} N, {:.4g} m): it is the first of {} with a spike, which are left out",
        first + 1, Q_[first], d_[first], rows.size());
    keep([&](Index i) { return !rows.contains(i); });
  }

  /// The rows that are good.
  void keep(const auto& good) {
    std::vector<Index> kept;
    for (Index i = 0; i < d_.size(); ++i) {
      if (good(i)) kept.push_back(i);
    }
    P_ = P_(kept).eval(), Q_ = Q_(kept).eval(), d_ = d_(kept).eval();
  }

  template <class... Values>
  void note(const char* code, fmt::format_string<Values...> message, Values&&... values) {
    result_.findings.push_back({code, fmt::format(message, std::forward<Values>(values)...)});
  }
  template <class... Values>
  void refuse(const char* code, fmt::format_string<Values...> message, Values&&... values) {
    note(code, message, std::forward<Values>(values)...);
    result_.findings.back().refused = result_.refused = true;
  }
  BendingTestResult finish() { return std::move(result_); }

  // The cable is straight where the load is nearest zero or, as a load cell has an offset, where
  // the deflection begins: where its square from there shows more of the tension. Strokes may go
  // both ways.
  void find_zero() {
    Index unloaded = 0;
    Q_.cwiseAbs().minCoeff(&unloaded);
    const auto likeness = [&](double zero) {
      const ArrayXd square = (d_.array() - zero).square(), off = square - square.mean();
      return (off * (P_.array() - mean_tension_)).sum() / off.matrix().norm();
    };
    zero_ = d_.minCoeff();
    if (likeness(d_[unloaded]) > likeness(zero_)) zero_ = d_[unloaded];
  }

  // While the cable is deflected its tension can only rise; what it loses for good slipped.
  void find_clamp_slip() {
    if (beam()) return;
    const double noise = sample_noise(P_);
    double worst = 0;
    for (const StrokeRange& run : runs_) {
      double highest = -std::numeric_limits<double>::infinity();
      for (Index i = run.first + 2; i + 2 <= run.last; ++i) {
        if (run.direction * (d_[i] - zero_) < 0) continue;  // unloaded
        const double local = signal::median({P_[i - 2], P_[i - 1], P_[i], P_[i + 1], P_[i + 2]});
        highest = std::max(highest, local);
        worst = std::max(worst, highest - local);
      }
    }
    if (worst > std::max(0.02 * mean_tension_, 8 * noise)) {
      const std::string message = fmt::format(
          "the tension fell by {:.3g} N ({:.1f} %) while the cable was being loaded, so a clamp "
          "slipped or the frame gave way",
          worst, 100 * worst / mean_tension_);
      if (worst > 0.1 * mean_tension_) {
        refuse("clamp_slip", "Tighten the clamps and repeat: {}", message);
      } else {
        note("clamp_slip", "Check the clamps: {}; the tension is used as measured", message);
      }
    }
  }

  // g(P): compliance at the mean tension over that at the tension of the moment.
  VectorXd tension_corrected(double EI) const {
    if (beam()) return d_.array() - zero_;
    const double span = options_.span_m.value;
    VectorXd x(d_.size());
    const double mean = EI > 0 ? midspan_compliance(EI, mean_tension_, span) : 1 / mean_tension_;
    for (Index i = 0; i < d_.size(); ++i) {
      const double P = std::max(P_[i], 0.0);
      const double g = EI > 0 ? mean / midspan_compliance(EI, P, span) : P / mean_tension_;
      x[i] = (d_[i] - zero_) * g;
    }
    return x;
  }

  /// False where there is no line.
  bool fit_strokes() {
    Index longest = 0;
    for (const auto& run : runs_) longest = std::max(longest, run.last - run.first + 1);
    averaged_ = longest >= kShortStroke;
    if (averaged_) {
      std::erase_if(runs_, [](const auto& run) { return run.last - run.first + 1 < 4; });
    } else {
      arrange_table();
    }
    if (runs_.empty()) {
      refuse("no_loading", "Load and unload in strokes of four samples or more: none was found");
      return false;
    }
    const bool both_ways = std::any_of(runs_.begin(), runs_.end(), [&](const auto& run) {
      return run.direction != runs_.front().direction;
    });
    const double slope = range_Q_ / range_d_;
    const double noise = std::hypot(load_noise_, deflection_noise_ * slope);
    // Where loads go up evenly they were set, and the deflection was read.
    const double of_load = read_step(Q_, false), of_deflection = read_step(d_, of_load == 0);
    const double step = averaged_ ? 0 : std::hypot(of_load, of_deflection * slope);
    double EI = 0, before = -1;
    for (int pass = 0; pass < 8; ++pass) {
      const VectorXd x = tension_corrected(EI);
      std::vector<TableStroke> strokes;
      off_ = 0;
      toe_ = stop_ = far_end_ = 0, straight_ = 1;
      for (std::size_t k = 0; k < runs_.size(); ++k) {
        auto run = runs_[k];
        // The row of a turn belongs to the stroke before.
        run.first += k > 0 && run.first == runs_[k - 1].last;
        auto stroke = rows_of(run, x, Q_, averaged_);
        const double samples =
            static_cast<double>(run.last - run.first + 1) / static_cast<double>(stroke.x_m.size());
        StraightPart part;
        if (averaged_ &&
            !leave_ends_out(stroke, both_ways ? kTurnShare : 0,
                            std::max(kStraight * range_Q_, 4 * noise / std::sqrt(samples)), part)) {
          continue;
        }
        // Friction jumps in the rows at turns.
        for (std::size_t i = 1; i + 1 < stroke.off.size(); ++i) {
          if (stroke.used[i] != 0) off_ += stroke.off[i];
        }
        toe_ = std::max(toe_, stroke.loading ? part.at_turn : part.at_end);
        if (stroke.loading) stop_ = std::max(stop_, part.at_end);
        far_end_ = std::max(far_end_, part.at_end);
        straight_ = std::min(straight_, part.share);
        strokes.push_back(std::move(stroke));
      }
      line_ = fit_table_line(strokes, averaged_, step / std::sqrt(12.0));
      if (!line_.usable) {
        refuse("no_slope",
               "Add rows, or check the signs of load and deflection: {} rows give no rising "
               "straight line of load over deflection with a scatter that can be seen",
               d_.size());
        return false;
      }
      take_line();
      // What is softer than a string has 0: its changing tension is then that of a string.
      EI = beam() ? 0
                  : EI_of_compliance(result_.compliance_m_N.value, mean_tension_,
                                     options_.span_m.value, options_.ends);
      if (std::abs(EI - before) <= 1e-7 * EI) break;
      before = EI;
    }
    return true;
  }

  /// Strokes of a short table.
  void arrange_table() {
    Index in_runs = 0;
    for (const auto& run : runs_) in_runs += run.last - run.first + 1;
    if (10 * in_runs < 7 * d_.size()) runs_ = {{0, d_.size() - 1, 1}};  // weights in any order
    // Weights that are added at a stop move nothing any more; they belong to the loading.
    for (std::size_t k = 0; k < runs_.size(); ++k) {
      Index& last = runs_[k].last;
      while (runs_[k].direction > 0 && last + 1 < d_.size() && d_[last + 1] == d_[last] &&
             Q_[last + 1] > Q_[last]) {
        ++last;
      }
      if (k + 1 < runs_.size()) runs_[k + 1].first = std::max(runs_[k + 1].first, last);
    }
  }

  void solve_for_EI() {
    result_.tension_N = {0, 0};
    if (!beam()) {
      result_.tension_N = {mean_tension_,
                           std::hypot(options_.tension_calibration_std * mean_tension_,
                                      options_.tension_zero_std_N)};
      const Index first = runs_.front().first, last = runs_.back().last;
      result_.tension_spread_N =
          tension_spread(P_.segment(first, last - first + 1), sample_noise(P_));
    }
    result_.hysteresis_N = line_.hysteresis_N;
    result_.stiffness = stiffness_from_compliance({result_.compliance_m_N, result_.tension_N,
                                                   options_.span_m, result_.degrees_of_freedom,
                                                   options_.ends, options_.clamp_stiffness_Nm_rad});
  }

  void judge_curvature(double curvature) {
    if (!(std::abs(curvature) > kCurvatureWarning)) return;
    const std::string message =
        fmt::format("the slope changes by {:+.0f} % over the straight part", 100 * curvature);
    if (std::abs(curvature) > kCurvatureRefusal) {
      refuse("curved", "{}{}", kNoStiffness, message);
    } else {
      note("curved", "Look for slip, a toe or a stop: {}; EI is that of its mean slope", message);
    }
  }

  void judge_line() {
    const TableLine& t = line_;
    if (toe_ > kEndSaid && !(t.hysteresis_N > 0)) {
      note("toe",
           "the first {:.0f} % of the deflection are left out as a toe (slack, supports or "
           "friction settle)",
           100 * toe_);
    }
    if (stop_ > kEndSaid) {
      note("stop",
           "Deflect less, or check for yield, slip, a stop or a sensor's end: the last {:.0f} % of "
           "the deflection leave the straight line and are left out",
           100 * stop_);
    }
    if (straight_ < kLeastStraight) {
      refuse("curved", "{}only {:.0f} % of a stroke is straight within {:.1f} % of the load",
             kNoStiffness, 100 * straight_, 100 * kStraight);
    }
    if (t.too_many_off) {
      refuse("curved", "{}more than one row in four lie off the line of the others", kNoStiffness);
    }
    if (off_ > 0) {
      note("spike", "Check for spikes: {} samples lie far off those beside them and are left out",
           off_);
    }
    if (t.left_out > 0) {
      note("spike",
           "Check for a stop, a toe or a misreading: {} {} off the line of the others and left out",
           t.left_out, t.left_out == 1 ? "row lies" : "rows lie");
    }
    const double friction = std::abs(t.friction_N_m) / t.slope_N_m;
    if (t.hysteresis_N > 0 &&
        (far_end_ > kEndSaid || (t.curved && std::abs(t.curvature) > kCurvatureRefusal))) {
      refuse("friction",
             "Deflect further, or less where there is a stop: loading and unloading lie {:.2g} N "
             "apart by wire friction, and the slope still changes after the turns, so that "
             "friction may turn round over most of a stroke",
             2 * t.hysteresis_N);
    } else if (friction > 1e-3) {
      note("friction",
           "loading and unloading lie {:.2g} N apart by wire friction, which stiffens the strand "
           "after every turn; the rows after the turns are left out, and the change by this adds "
           "to the uncertainty",
           2 * t.hysteresis_N);
    }
    if (t.strokes_differ && t.slope_std_N_m > kScatterSaid * t.slope_N_m) {
      note("strokes_differ",
           "Repeat the strokes, or check the clamps: their slopes differ by more than their noise "
           "(5 %), and this scatter widens the interval of EI");
    }
    if (t.curved) {
      judge_curvature(t.curvature);
    } else if (t.curvature_half > kCurvatureRefusal) {
      note("straightness_unknown",
           "Add rows: too few or too scattered to show whether the diagram is straight (its slope "
           "may change by {:.0f} % unseen)",
           100 * std::min(10.0, std::abs(t.curvature) + t.curvature_half));
    }
  }

  void judge_slope() {
    const double relative = result_.compliance_m_N.std / result_.compliance_m_N.value;
    if (relative > 0.3) {
      refuse("no_slope",
             "Load further, or repeat: noise or strokes that do not agree make the slope uncertain "
             "by {:.0f} %",
             100 * relative);
    }
    const auto status = result_.stiffness.status;
    if (status == BendingStatus::upper_bound_only) {
      note("upper_bound_only", "{}", result_.stiffness.reason);
    } else if (status != BendingStatus::solved) {
      refuse(status == BendingStatus::string_like ? "string_like" : "no_EI", "{}",
             result_.stiffness.reason);
    }
  }

  /// The slope with what it shares with all rows; Welch and Satterthwaite's degrees of freedom.
  void take_line() {
    const double K = line_.slope_N_m;
    const double scatter = std::pow(std::max(line_.slope_std_N_m, 1e-10 * K), 2);
    const double variance = scatter + std::pow(line_.friction_N_m, 2) +
                            K * K *
                                (std::pow(options_.load_calibration_std, 2) +
                                 std::pow(options_.deflection_calibration_std, 2));
    result_.compliance_m_N = {1 / K, std::sqrt(variance) / (K * K)};
    result_.degrees_of_freedom = line_.degrees_of_freedom * std::pow(variance / scatter, 2);
    if (!(result_.degrees_of_freedom < 1000)) result_.degrees_of_freedom = 0;
  }

  BendingTestOptions options_;
  BendingTestResult result_;
  VectorXd P_, Q_, d_;
  std::vector<StrokeRange> runs_;
  TableLine line_;
  bool averaged_ = false;  // rows are averages of long strokes
  int off_ = 0;            // samples left out of them
  double load_noise_ = 0, deflection_noise_ = 0;
  double range_d_ = 0, range_Q_ = 0, mean_tension_ = 0, zero_ = 0;
  double toe_ = 0, stop_ = 0, far_end_ = 0,
         straight_ = 1;  // StraightPart, extremes over the strokes
};

}  // namespace

BendingTestResult analyse_bending_test(const BendingRecord& record,
                                       const BendingTestOptions& options) {
  return Analysis(record, options).run();
}

std::vector<BendingRecord> split_by_tension(const BendingRecord& table) {
  const Index n = table.tension_N.size();
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    return table.tension_N[a] < table.tension_N[b];  // NaN never compares; such rows stay together
  });
  std::vector<std::vector<Index>> clusters;
  for (Index index : order) {
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
  for (auto& rows : clusters) {
    std::sort(rows.begin(), rows.end());
    records.push_back({table.tension_N(rows), table.load_N(rows), table.deflection_m(rows)});
  }
  return records;
}

}  // namespace rigfit::ident
