#include "ident/bending/bending_judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "ident/bending/bending_pooling.h"

namespace rigfit::ident {
namespace {

class Judgement {
 public:
  Judgement(const BendingCurve& curve, const TableLine& table, const BendingTestOptions& options,
            BendingTestResult& result)
      : curve_(curve), table_(table), options_(options), result_(result) {}

  void judge() {
    result_.loading_stiffness_N_m = mean_of(true);
    result_.unloading_stiffness_N_m = mean_of(false);
    survey();
    if (table_.usable) {
      judge_table();
    } else {
      if (result_.ends == BeamEnds::tensioned) judge_ends();
      judge_straightness();
    }
    judge_slope();
  }

 private:
  /// What lies before and after the straight parts.
  void survey() {
    const auto &d = curve_.deflection_m, &P = curve_.tension_N, &Q = curve_.load_N;
    int loadings = 0, unloadings = 0;
    double loading_offset = 0, unloading_offset = 0;
    result_.tension_low_N = std::numeric_limits<double>::infinity();
    result_.tension_high_N = 0;
    for (const auto& s : result_.strokes) {
      drops_ += s.load_drops;
      (s.loading ? loadings : unloadings) += 1;
      (s.loading ? loading_offset : unloading_offset) += s.offset_N;
      const double travel = d[s.last] - d[s.first];
      const double before = (d[s.used_first] - d[s.first]) / travel;
      const double after = (d[s.last] - d[s.used_last]) / travel;
      least_straight_ = std::min(least_straight_, 1 - before - after);
      toe_ = std::max(toe_, s.loading ? before : after);
      if (s.loading) top_ = std::max(top_, after);
      // A stop: the load goes on rising where the deflection hardly does.
      const Eigen::Index end = s.loading ? s.last : s.first;
      const Eigen::Index knee = s.loading ? s.used_last : s.used_first;
      const double rise = std::abs(Q[end] - Q[knee]), way = std::abs(d[end] - d[knee]);
      if (rise > 0.02 * curve_.load_range_N) {
        steepest_top_ =
            std::max(steepest_top_, rise / std::max(way, 1e-12 * curve_.deflection_range_m) /
                                        s.stiffness_N_m.value);
      }
      if (std::abs(s.curvature) > std::abs(curvature_)) {
        curvature_ = s.curvature;
        curvature_std_ = s.curvature_std;
      }
      for (Eigen::Index i = s.used_first; i <= s.used_last; ++i) {
        result_.tension_low_N = std::min(result_.tension_low_N, P[i]);
        result_.tension_high_N = std::max(result_.tension_high_N, P[i]);
      }
    }
    if (!table_.usable && loadings > 0 && unloadings > 0) {
      result_.hysteresis_N = 0.5 * (loading_offset / loadings - unloading_offset / unloadings);
    }
  }

  void judge_ends() {
    if (result_.friction_probability > 0.5 &&
        std::abs(result_.relative_friction_correction) > 1e-3) {
      note(
          "friction",
          fmt::format("wire friction stiffens the first {:.2g} mm after every turn (by {:.2g} N in "
                      "all); without it the slope is {:+.1f} % of a straight line's",
                      1e3 * result_.friction_travel_m, 2 * result_.friction_load_N,
                      100 * result_.relative_friction_correction));
    } else if (toe_ > options_.turn_share + 0.05) {
      note("toe", fmt::format("the first {:.0f} % of the deflection are a toe (slack or friction "
                              "being taken up) and were left out",
                              100 * toe_));
    }
    if (steepest_top_ > 2) {
      note("stop",
           fmt::format("above the straight part the load rises {:.1f} times as steeply: the "
                       "deflection met a stop or its sensor's end; left out",
                       steepest_top_));
    } else if (top_ > options_.turn_share + 0.05) {
      note("top", fmt::format("the last {:.0f} % of the loading leave the straight line and were "
                              "left out",
                              100 * top_));
    }
  }

  void judge_straightness() {
    if (drops_ > 0) {
      note("stick_slip", fmt::format("{} sudden losses of load: stick-slip; the robust line passes "
                                     "through what lies between",
                                     drops_));
    }
    if (result_.ends == BeamEnds::tensioned && least_straight_ < options_.least_straight_share) {
      refuse("curved",
             fmt::format("only {:.0f} % of a stroke are straight within {:.1f} % of the load: a "
                         "curved load-deflection diagram has no one EI; load less, or look for "
                         "slip, a stop or loose clamps",
                         100 * std::max(0.0, least_straight_), 100 * options_.straightness));
    } else if (std::abs(curvature_) > options_.curvature_warning &&
               std::abs(curvature_) > 3 * curvature_std_) {
      const std::string message =
          fmt::format("the slope changes by {:+.0f} % over the straight part", 100 * curvature_);
      if (result_.friction_probability > 0.9 &&
          std::abs(curvature_) > 2 * options_.curvature_warning) {
        refuse("friction",
               message +
                   " although wire friction after the turns is taken out: it turns round "
                   "over most of a stroke, and no slope is free of it; deflect further");
      } else if (std::abs(curvature_) > options_.curvature_refusal) {
        refuse("curved", message + ": a curved load-deflection diagram has no one EI");
      } else {
        note("curved", message + "; EI is that of its mean slope");
      }
    }
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

  void note(std::string code, std::string message) {
    result_.findings.push_back({std::move(code), std::move(message), false});
  }
  void refuse(std::string code, std::string message) {
    result_.findings.push_back({std::move(code), std::move(message), true});
    result_.refused = true;
  }

  /// Rows above the straight part of a table.
  void note_top() {
    Eigen::Index left_out = 0;
    double highest = -std::numeric_limits<double>::infinity();
    for (const auto& s : result_.strokes) {
      left_out += s.loading ? s.last - s.used_last : s.used_first - s.first;
      highest = std::max(highest, curve_.load_N[s.loading ? s.used_last : s.used_first]);
    }
    const std::string which = fmt::format(
        "{} above {:.4g} N", left_out == 1 ? "1 row" : fmt::format("{} rows", left_out), highest);
    if (steepest_top_ > 2) {
      note("stop", fmt::format("{} rise {:.1f} times as steeply as the line (F-test): the "
                               "deflection met a stop or its sensor's end; left out",
                               which, steepest_top_));
    } else {
      note("top", fmt::format("{}, the last {:.0f} % of the deflection, leave the straight line "
                              "(F-test) and were left out",
                              which, 100 * table_.top_share));
    }
  }

  void judge_table() {
    const TableLine& t = table_;
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
    // Rows at a hard stop have no share of the deflection.
    const bool rows_above =
        std::any_of(result_.strokes.begin(), result_.strokes.end(),
                    [](const BendingStroke& s) { return s.loading && s.used_last < s.last; });
    if (t.top_share > 0 || (rows_above && t.spikes.empty())) note_top();
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

  signal::Estimate mean_of(bool loading) const {
    double weight = 0, sum = 0;
    for (const auto& s : result_.strokes) {
      if (s.loading != loading) continue;
      const double w = 1 / slope_variance(s.stiffness_N_m);
      weight += w, sum += w * s.stiffness_N_m.value;
    }
    if (weight == 0) return {};
    return {sum / weight, 1 / std::sqrt(weight)};
  }

  const BendingCurve& curve_;
  const TableLine& table_;
  const BendingTestOptions& options_;
  BendingTestResult& result_;
  // Of all strokes: shares of the travel, the worst of them.
  double toe_ = 0, top_ = 0, least_straight_ = 1;
  double steepest_top_ = 0;  ///< slope beyond the straight part, relative to it
  double curvature_ = 0, curvature_std_ = 0;
  int drops_ = 0;
};

}  // namespace

void judge_bending(const BendingCurve& curve, const TableLine& table,
                   const BendingTestOptions& options, BendingTestResult& result) {
  Judgement(curve, table, options, result).judge();
}

}  // namespace rigfit::ident
