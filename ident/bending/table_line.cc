#include "ident/bending/table_line.h"

#include <gsl/gsl_cdf.h>

#include "signal/estimation/groups.h"
#include "signal/estimation/robust.h"
#include "signal/numerics/factorisations.h"

namespace rigfit::ident {
namespace {

using Mask = std::vector<std::vector<char>>;

/// Least squares of a line (and parabola) common to the strokes.
struct Fit {
  bool usable = false;
  double squares = 0, freedom = 0;
  double slope = 0, slope_variance_factor = 0;  // slope; its variance over the noise's
  double bend = 0, bend_variance_factor = 0;    // relative change of slope over the range
  std::vector<double> offsets;
  std::vector<std::pair<std::size_t, std::size_t>> rows;  // stroke, row
  VectorXd residual, leverage;
};

class Table {
 public:
  Table(const std::vector<TableStroke>& strokes, bool averaged, double rounding_N)
      : strokes_(strokes), averaged_(averaged), rounding_(rounding_N) {
    double high = -INFINITY, most = -INFINITY;
    for (const auto& stroke : strokes) {
      line_.used.push_back(stroke.used);
      both_ways_ = both_ways_ || stroke.loading != strokes.front().loading;
      low_ = std::min(low_, stroke.x_m.minCoeff()), high = std::max(high, stroke.x_m.maxCoeff());
      least_ = std::min(least_, stroke.load_N.minCoeff());
      most = std::max(most, stroke.load_N.maxCoeff());
    }
    range_ = high - low_, load_range_ = most - least_;
  }

  TableLine run() {
    if (!(range_ > 0 && load_range_ > 0)) return line_;
    const Fit all = fit(line_.used);
    averaged_ ? leave_turns_out() : leave_block_out();
    while (!line_.too_many_off && improve()) {
      line_.too_many_off = 4 * ++line_.left_out > static_cast<int>(all.rows.size()) + 3;
    }
    if (!averaged_) leave_turns_out();
    finish();
    return line_;
  }

 private:
  /// A line alone; with a parabola; that of the deflection over the load, in the load's unit; with
  /// one that turns with the direction, as friction after a turn does.
  enum class Bend { none, over_deflection, over_load, after_turn };
  [[nodiscard]] Fit fit(const Mask& mask, Bend bend = Bend::none, bool over_load = false) const {
    const bool parabola = bend != Bend::none;
    Fit fit;
    std::vector<Index> column(strokes_.size(), -1);
    Index offsets = 0;
    for (std::size_t s = 0; s < strokes_.size(); ++s) {
      for (std::size_t i = 0; i < mask[s].size(); ++i) {
        if (!mask[s][i]) continue;
        if (column[s] < 0) column[s] = offsets++;
        fit.rows.emplace_back(s, i);
      }
    }
    const auto rows = static_cast<Index>(fit.rows.size());
    const Index parameters = offsets + 1 + (parabola ? 1 : 0);
    fit.freedom = static_cast<double>(rows - parameters);
    if (rows < parameters) return fit;
    MatrixXd A = MatrixXd::Zero(rows, parameters);
    VectorXd y(rows);
    double least = 1, most = 0;
    for (Index r = 0; r < rows; ++r) {
      const auto [s, i] = fit.rows[static_cast<std::size_t>(r)];
      const double x = (strokes_[s].x_m[static_cast<Index>(i)] - low_) / range_;
      const double Q = strokes_[s].load_N[static_cast<Index>(i)];
      const double u = over_load ? (Q - least_) / load_range_ : x;
      least = std::min(least, u), most = std::max(most, u);
      A(r, column[s]) = 1;
      A(r, offsets) = u - 0.5;
      const double sign = bend == Bend::after_turn && !strokes_[s].loading ? -1 : 1;
      if (parabola) A(r, offsets + 1) = sign * (u - 0.5) * (u - 0.5);
      y[r] = over_load ? x * load_range_ : Q;
    }
    const signal::ScaledGram gram(A.transpose() * A);
    if (!gram.usable()) return fit;
    const MatrixXd inverse = gram.inverse();
    VectorXd p = gram.solve_vector(A.transpose() * y);
    p += gram.solve_vector(A.transpose() * (y - A * p));  // takes off what rounding left
    fit.residual = y - A * p;
    fit.squares = fit.residual.squaredNorm();
    fit.leverage = (A * inverse).cwiseProduct(A).rowwise().sum();
    fit.slope = p[offsets] / range_;
    fit.slope_variance_factor = inverse(offsets, offsets) / (range_ * range_);
    if (parabola && p[offsets] != 0) {
      const double scale = 2 * (most - least) / p[offsets];
      fit.bend = scale * p[offsets + 1];
      fit.bend_variance_factor = scale * scale * inverse(offsets + 1, offsets + 1);
    }
    fit.offsets.assign(strokes_.size(), kNaN);
    for (std::size_t s = 0; s < strokes_.size(); ++s) {
      if (column[s] >= 0) fit.offsets[s] = p[column[s]] - (low_ / range_ + 0.5) * p[offsets];
    }
    fit.usable = true;
    return fit;
  }

  /// Variance of the noise by a fit; hardly any numbers are good to more than six digits.
  [[nodiscard]] double variance(double squares, double freedom) const {
    return std::max(freedom > 0 ? squares / freedom : 0, rounding_ * rounding_);
  }
  [[nodiscard]] double tested(double squares, double freedom) const {
    return std::max(variance(squares, freedom), std::pow(1e-6 * load_range_, 2));
  }

  struct Curve {
    double chance = 1;             // that the line is right
    Estimate change{0, INFINITY};  // relative change of slope, half its 95 % interval
  };

  /// A parabola against the line, of the load over the deflection (a toe, a curve), of the
  /// deflection over the load (a stop) and, with strokes both ways, after the turns (friction).
  [[nodiscard]] Curve curve(const Mask& mask) const {
    Curve best;
    for (const Bend bend : {Bend::over_deflection, Bend::over_load, Bend::after_turn}) {
      const bool over_load = bend == Bend::over_load;
      if (bend == Bend::after_turn && !both_ways_) continue;
      const Fit line = fit(mask, Bend::none, over_load), parabola = fit(mask, bend, over_load);
      if (!line.usable || !parabola.usable || !(parabola.freedom >= 1) || !(parabola.slope > 0)) {
        continue;
      }
      const double F = std::max(0.0, line.squares - parabola.squares) /
                       tested(parabola.squares, parabola.freedom);
      const double chance =
          std::min(1.0, (both_ways_ ? 3 : 2) * gsl_cdf_fdist_Q(F, 1, parabola.freedom));
      if (std::isfinite(best.change.std) && !(chance < best.chance)) continue;
      best.chance = chance;
      best.change = {over_load ? -parabola.bend : parabola.bend,
                     gsl_cdf_tdist_Qinv(0.025, parabola.freedom) *
                         std::sqrt(variance(parabola.squares, parabola.freedom) *
                                   parabola.bend_variance_factor)};
    }
    return best;
  }

  /// Rows off a line that three quarters of them share (a stop, a toe), against the robust line by
  /// the median of all slopes (Theil and Sen); where the others are no straight line all stay.
  void leave_block_out() {
    std::vector<double> slopes, off;
    for (const auto& stroke : strokes_) {
      for (Index i = 0; i < stroke.x_m.size(); ++i) {
        for (Index k = i + 1; k < stroke.x_m.size(); ++k) {
          const double step = stroke.x_m[k] - stroke.x_m[i];
          if (step != 0) slopes.push_back((stroke.load_N[k] - stroke.load_N[i]) / step);
        }
      }
    }
    const double slope = signal::median(slopes);
    for (const auto& stroke : strokes_) {
      const VectorXd rest = stroke.load_N - slope * stroke.x_m;
      const double offset = signal::median({rest.begin(), rest.end()});
      for (const double r : rest) off.push_back(std::abs(r - offset));
    }
    const double scale = std::max(signal::robust_std(off, 0), std::sqrt(tested(0, 0)));
    Mask mask = line_.used;
    std::size_t row = 0;
    int out = 0;
    for (auto& stroke : mask) {
      for (char& used : stroke) {
        if (off[row++] > 8 * scale) used = 0, ++out;
      }
    }
    if (out < 2 || 4 * out > static_cast<int>(off.size()) || off.size() < 6) return;
    const Fit rest = fit(mask);
    if (!rest.usable || rest.freedom < 3 || curve(mask).chance < 0.01) return;
    line_.used = mask, line_.left_out = out;
  }

  /// Leaves the row out that is furthest off the others' line; false: the line, or a curve, stands.
  bool improve() {
    const Fit line = fit(line_.used);
    if (!line.usable || line.freedom < 2) return false;
    double worst = 1;
    std::size_t row = 0;
    for (Index r = 0; r < line.residual.size(); ++r) {
      const double rest = std::max(1e-12, 1 - line.leverage[r]);
      const double own = line.residual[r] * line.residual[r] / rest;
      const double t = std::sqrt(own / tested(std::max(0.0, line.squares - own), line.freedom - 1));
      const double chance =
          2 * gsl_cdf_tdist_Q(t, line.freedom - 1) * static_cast<double>(line.residual.size());
      if (chance < worst) worst = chance, row = static_cast<std::size_t>(r);
    }
    if (!(worst < 0.01) || curve(line_.used).chance <= worst) return false;
    const auto [s, i] = line.rows[row];
    line_.used[s][i] = 0;
    return true;
  }

  void leave_turns_out() {
    const Fit all = fit(line_.used);
    if (!all.usable || all.freedom < 3) return;
    double up = 0, down = 0, ups = 0, downs = 0, rows_up = 0, rows_down = 0;
    for (std::size_t s = 0; s < strokes_.size(); ++s) {
      if (!std::isfinite(all.offsets[s])) continue;
      const auto rows = std::count(line_.used[s].begin(), line_.used[s].end(), 1);
      (strokes_[s].loading ? up : down) += all.offsets[s];
      (strokes_[s].loading ? ups : downs) += 1;
      (strokes_[s].loading ? rows_up : rows_down) += static_cast<double>(rows);
    }
    if (ups == 0 || downs == 0) return;
    const double apart = up / ups - down / downs;
    const double std =
        std::sqrt(variance(all.squares, all.freedom) * (1 / rows_up + 1 / rows_down));
    if (!(apart > gsl_cdf_tdist_Qinv(0.005, all.freedom) * std + 1e-6 * load_range_)) return;
    line_.hysteresis_N = 0.5 * apart;
    Mask mask = line_.used;
    for (std::size_t s = 0; s < mask.size(); ++s) {
      const auto& x = strokes_[s].x_m;
      for (std::size_t i = 0; i < mask[s].size(); ++i) {
        const double way = std::abs(x[static_cast<Index>(i)] - x[0]);
        if (way < kFrictionShare * std::abs(x[x.size() - 1] - x[0])) mask[s][i] = 0;
      }
    }
    const Fit rest = fit(mask);
    if (!rest.usable || rest.freedom < 2 || !(rest.slope > 0)) return;
    line_.used = mask;
    line_.friction_N_m = rest.slope - all.slope;
  }

  void finish() {
    const Fit best = fit(line_.used);
    if (!best.usable || best.freedom < 1 || !(best.slope > 0)) return;
    const double noise2 = variance(best.squares, best.freedom);
    line_.degrees_of_freedom = best.freedom;
    double chi = 0;
    std::vector<double> slopes, variances;
    for (std::size_t s = 0; s < strokes_.size(); ++s) {
      std::vector<Index> used;
      for (std::size_t i = 0; i < line_.used[s].size(); ++i) {
        if (line_.used[s][i]) used.push_back(static_cast<Index>(i));
      }
      ArrayXd x = strokes_[s].x_m(used), y = strokes_[s].load_N(used);
      if (!used.empty()) x -= x.mean(), y -= y.mean();
      const double xx = x.square().sum(), slope = (x * y).sum() / xx;
      if (!(xx > 0)) continue;
      chi += xx * std::pow(slope - best.slope, 2) / std::max(noise2, 1e-300);
      slopes.push_back(slope);
      variances.push_back(std::max(noise2 / xx, std::pow(1e-10 * slope, 2)));
    }
    line_.slope_N_m = best.slope;
    line_.slope_std_N_m = std::sqrt(noise2 * best.slope_variance_factor);
    const double more = static_cast<double>(slopes.size()) - 1;
    if (more > 0 && best.freedom > more) {
      line_.strokes_differ = gsl_cdf_fdist_Q(chi / more, more, best.freedom - more) < 0.05;
    }
    if (line_.strokes_differ) {
      const auto mean = signal::mean_over_groups(slopes, variances);
      if (mean.variance > std::pow(line_.slope_std_N_m, 2)) {
        line_.slope_N_m = mean.mean, line_.slope_std_N_m = std::sqrt(mean.variance);
        if (mean.degrees > 0) line_.degrees_of_freedom = mean.degrees;
      }
    }
    line_.usable = true;

    const Curve bent = curve(line_.used);
    line_.curvature = bent.change.value, line_.curvature_half = bent.change.std;
    line_.curved = bent.chance < 0.01;
    // Where on a curve the slope is that of small deflections is not known: rectangular.
    if (line_.curved) {
      line_.slope_std_N_m =
          std::hypot(line_.slope_std_N_m, line_.slope_N_m * line_.curvature / std::sqrt(12.0));
    }
  }

  const std::vector<TableStroke>& strokes_;
  bool averaged_ = false, both_ways_ = false;
  double low_ = INFINITY, range_ = 0, least_ = INFINITY, load_range_ = 0, rounding_ = 0;
  TableLine line_;
};

}  // namespace

TableLine fit_table_line(const std::vector<TableStroke>& strokes, bool averaged,
                         double rounding_N) {
  return strokes.empty() ? TableLine{} : Table(strokes, averaged, rounding_N).run();
}

}  // namespace rigfit::ident
