#include "ident/tension/tension_posterior.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "ident/statistics/root.h"

namespace rigfit::ident {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr double kLowX = 2, kHighX = 2000;             // L sqrt(T / EI) where EI is not given
constexpr double kLowSpring = 0.03, kHighSpring = 30;  // q
constexpr double kNegligible = 18;                     // in ln(weight)

double ln_sum(const std::vector<TensionCell>& cells) {
  double top = -kUnbounded, sum = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) top = std::max(top, cells[i].ln_weight);
  if (!std::isfinite(top)) return -kUnbounded;
  for (std::size_t i = 0; i < cells.size(); ++i) sum += std::exp(cells[i].ln_weight - top);
  return top + std::log(sum);
}

struct Range {
  double low = 0, high = 0;
};

/// A value on a grid, its cells, and ln of their sum for each value of t.
struct GridPoint {
  double at = 0;
  std::vector<TensionCell> cells;
  std::array<double, kModelStd.size()> ln{};

  [[nodiscard]] const TensionCell* heaviest() const {
    const auto found =
        std::max_element(cells.begin(), cells.end(),
                         [](const auto& a, const auto& b) { return a.ln_weight < b.ln_weight; });
    return found == cells.end() ? nullptr : &*found;
  }

  void sum_up() {
    for (std::size_t t = 0; t < ln.size(); ++t) {
      double top = -kUnbounded, sum = 0;
      for (const auto& cell : cells) {
        if (cell.model_std == kModelStd[t]) top = std::max(top, cell.ln_weight);
      }
      for (const auto& cell : cells) {
        if (cell.model_std == kModelStd[t] && std::isfinite(top))
          sum += std::exp(cell.ln_weight - top);
      }
      ln[t] = sum > 0 ? top + std::log(sum) : -kUnbounded;
    }
  }
};

constexpr double kMatters = 10;  // below the top, in ln
// Below the best answer, in ln: all that is left coarse has less than a thousandth of the weight.
constexpr double kCounts = 10;
constexpr double kClimb = 3;       // below the top of a peak that is looked for, in ln
constexpr double kSmoothStep = 1;  // in ln, between neighbours that resolve a density

/// Whether the interval after point i needs a point between. A peak between coarse points is seen
/// by the parabola through three of them. Nothing below `matters` does.
bool needs_point(const std::vector<GridPoint>& points, std::size_t i, double matters) {
  for (std::size_t t = 0; t < kModelStd.size(); ++t) {
    const double a = points[i].ln[t], b = points[i + 1].ln[t];
    if (!std::isfinite(a) || !std::isfinite(b)) continue;
    if (std::abs(a - b) > kSmoothStep && std::max(a, b) > matters) return true;
    for (const std::size_t middle : {i, i + 1}) {
      if (middle == 0 || middle + 1 >= points.size()) continue;
      const double x0 = points[middle - 1].at, x1 = points[middle].at, x2 = points[middle + 1].at;
      const double y0 = points[middle - 1].ln[t], y1 = points[middle].ln[t],
                   y2 = points[middle + 1].ln[t];
      if (!(y1 >= y0 && y1 >= y2 && std::isfinite(y0) && std::isfinite(y2))) continue;
      if (!(std::max(y1 - y0, y1 - y2) > kSmoothStep)) continue;
      const double left = (y1 - y0) / (x1 - x0), right = (y2 - y1) / (x2 - x1);
      const double bend = (right - left) / (x2 - x0);
      if (!(bend < 0)) continue;
      const double slope = left + bend * (x1 - x0);  // at x1
      if (y1 - slope * slope / (4 * bend) > matters) return true;
    }
  }
  return false;
}

/// Cells of a density over a range: points are added until it is resolved for every value of t
/// that matters, within exp(-kMatters) of the top; where the top is far below the best answer, only
/// as near to it as finds a higher one. Weights of the trapezoidal rule. `evaluate` gets the place,
/// the heaviest cell of a neighbour (null: none) and where cells go; it is called from `origin`
/// outward, so that one branch of the tension is followed.
template <class Evaluate>
std::vector<TensionCell> resolved(const Range& range, int count, double origin, double counts,
                                  const Evaluate& evaluate) {
  std::vector<GridPoint> points(static_cast<std::size_t>(count));
  const auto fill = [&](GridPoint& point, double at, const TensionCell* near) {
    point.at = at;
    evaluate(at, near, point.cells);
    point.sum_up();
  };
  const auto place = [&](int i) { return range.low + (range.high - range.low) * i / (count - 1); };
  const double share = std::clamp((origin - range.low) / (range.high - range.low), 0.0, 1.0);
  const int first = static_cast<int>(std::lround(share * (count - 1)));
  const auto at = [&](int i) -> GridPoint& { return points[static_cast<std::size_t>(i)]; };
  fill(at(first), place(first), nullptr);
  for (int i = first + 1; i < count; ++i) fill(at(i), place(i), at(i - 1).heaviest());
  for (int i = first - 1; i >= 0; --i) fill(at(i), place(i), at(i + 1).heaviest());
  for (int pass = 0; pass < 14 && points.size() < 150; ++pass) {
    double top = -kUnbounded;
    for (const auto& one : points)
      top = std::max(top, *std::max_element(one.ln.begin(), one.ln.end()));
    if (!std::isfinite(top)) break;
    const double matters = std::max(top - kMatters, std::min(top - kClimb, counts));
    std::vector<GridPoint> added;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      if (!needs_point(points, i, matters)) continue;
      const TensionCell *left = points[i].heaviest(), *right = points[i + 1].heaviest();
      const bool from_left =
          left != nullptr && (right == nullptr || left->ln_weight > right->ln_weight);
      fill(added.emplace_back(), (points[i].at + points[i + 1].at) / 2, from_left ? left : right);
    }
    if (added.empty()) break;
    for (auto& one : added) points.push_back(std::move(one));
    std::sort(points.begin(), points.end(),
              [](const auto& a, const auto& b) { return a.at < b.at; });
  }
  std::vector<TensionCell> cells;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double left = points[i > 0 ? i - 1 : 0].at;
    const double right = points[std::min(i + 1, points.size() - 1)].at;
    const double ln_width = std::log((right - left) / 2);
    for (auto& cell : points[i].cells) {
      cell.ln_weight += ln_width;
      cells.push_back(cell);
    }
  }
  return cells;
}

double spring_of(double q, double EI, double tension, double L) {
  if (q == 0 || std::isinf(q)) return q;
  return q * EI * (L * std::sqrt(tension / EI) + 4) / L;
}

}  // namespace

bool EI_is_exact(const CableDescription& cable) {
  return cable.EI_Nm2 && !(cable.EI_Nm2->std > 0 && cable.EI_Nm2->value > 0);
}

double given_EI(const CableDescription& cable, double tension_N) {
  const double L = cable.length_m.value;
  return std::max(cable.EI_Nm2 ? cable.EI_Nm2->value : 0.0, 1e-10 * tension_N * L * L);
}

TensionAnswer tension_answer(const CableModel& model, const TensionData& data, CableEnds ends,
                             const Assignment& assignment, double ln_evidence_of_best) {
  TensionAnswer answer;
  answer.modes = assignment.modes;
  TensionFit local(model, data, answer.modes);
  if (local.pairs() == 0) return answer;
  const auto& cable = model.cable();
  const double L = cable.length_m.value;
  const bool given = cable.EI_Nm2.has_value();
  // What is far below the best answer needs no fine grid.
  const double counts = ln_evidence_of_best - kCounts - assignment.ln_prior;
  CableState first{std::exp(assignment.ln_tension)};
  first.EA = assignment.EA;
  int spring_index = 0, rigidity_index = 0;
  const auto at_rigidity = [&](double q, double y, double ln_prior, const TensionCell* near,
                               std::vector<TensionCell>& cells) {
    const auto state_at = [&](double ln_tension) {
      const double T = std::exp(ln_tension);
      const double EI = given ? given_EI(cable, T) : T * L * L * std::exp(-2 * y);
      return CableState{.tension_N = T,
                        .EI_Nm2 = EI,
                        .spring_Nm_rad = spring_of(q, EI, T, L),
                        .first_pinned = ends == CableEnds::pinned_clamped};
    };
    if (!(near != nullptr && local.fit(near->state, state_at)) && !local.fit(first, state_at)) {
      return;
    }
    TensionCell cell;
    cell.spring = spring_index;
    cell.rigidity = rigidity_index++;
    local.add_cells(ln_prior, cell, cells);
  };
  const auto at_spring = [&](double q, double ln_prior, const TensionCell* near,
                             std::vector<TensionCell>& cells) {
    rigidity_index = 0;
    if (given) {
      at_rigidity(q, 0, ln_prior, near, cells);
    } else {
      const Range range{std::log(kLowX), std::log(kHighX)};
      const double ln_flat = -std::log(range.high - range.low);
      const double x = near != nullptr ? L * std::sqrt(near->state.tension_N / near->state.EI_Nm2)
                                       : assignment.x;
      cells = resolved(range, 15, std::log(x), counts,
                       [&](double y, const TensionCell* beside, auto& into) {
                         at_rigidity(q, y, ln_prior + ln_flat, beside ? beside : near, into);
                       });
    }
    ++spring_index;
  };
  if (ends == CableEnds::springs) {
    const Range range{std::log(kLowSpring), std::log(kHighSpring)};
    const double ln_flat = -std::log(range.high - range.low);
    const double origin = std::log(std::clamp(assignment.q, kLowSpring, kHighSpring));
    answer.cells =
        resolved(range, 9, origin, counts, [&](double ln_q, const TensionCell* near, auto& cells) {
          at_spring(std::exp(ln_q), ln_flat, near, cells);
        });
  } else {
    at_spring(ends == CableEnds::pinned ? 0 : kUnbounded, 0, nullptr, answer.cells);
  }
  double top = -kUnbounded;
  for (const auto& cell : answer.cells) top = std::max(top, cell.ln_weight);
  std::erase_if(answer.cells,
                [top](const auto& cell) { return !(cell.ln_weight > top - kNegligible); });
  if (answer.cells.empty()) return answer;
  answer.best = static_cast<std::size_t>(
      std::max_element(answer.cells.begin(), answer.cells.end(),
                       [](const auto& a, const auto& b) { return a.ln_weight < b.ln_weight; }) -
      answer.cells.begin());
  std::vector<TensionData::Listed> listed;
  data.list(model.frequencies(answer.state(), 200, 1.05 * data.highest_hz), listed);
  answer.ln_prior = data.ln_assigned(answer.modes, listed);
  for (auto& cell : answer.cells) cell.ln_weight += answer.ln_prior;
  answer.ln_evidence = ln_sum(answer.cells);
  return answer;
}

CableState refitted(const CableModel& model, const TensionData& data,
                    const std::vector<AssignedMode>& modes, const CableState& state) {
  TensionFit local(model, data, modes);
  const auto& cable = model.cable();
  const double base = state.EI_Nm2 / state.EI, L = cable.length_m.value,
               x = L * std::sqrt(state.tension_N / base);
  const double q = state.spring_Nm_rad * L / (base * (x + 4));
  const bool done = local.fit(state, [&](double ln_tension) {
    const double T = std::exp(ln_tension);
    const double EI = cable.EI_Nm2 ? base : T * L * L / (x * x);
    return CableState{.tension_N = T,
                      .EI_Nm2 = EI,
                      .spring_Nm_rad = spring_of(q, EI, T, L),
                      .first_pinned = state.first_pinned};
  });
  return done ? local.state() : state;
}

namespace {

/// A weighted normal of ln T, and where it comes from.
struct Part {
  double weight = 0, ln_tension = 0, variance = 0;
};

double mixture_quantile(const std::vector<Part>& parts, double probability) {
  double low = kUnbounded, high = -kUnbounded;
  for (const auto& part : parts) {
    const double reach = 8 * std::sqrt(part.variance) + 1e-12;
    low = std::min(low, part.ln_tension - reach);
    high = std::max(high, part.ln_tension + reach);
  }
  // Over 1 + ln T - low, which is not near zero.
  const double place = root_between(1, 1 + high - low, 1e-10, [&](double x) {
    double below = 0;
    for (const auto& part : parts) {
      const double deviation = (part.ln_tension - (low + x - 1)) / std::sqrt(2 * part.variance);
      below += part.weight * 0.5 * std::erfc(deviation);
    }
    return below - probability;
  });
  return std::exp(low + place - 1);
}

/// Variance of ln T within one cell.
double cell_variance(const TensionCell& cell) {
  return std::accumulate(cell.variance_input.begin(), cell.variance_input.end(),
                         cell.variance_frequency + cell.variance_model);
}

/// All cells; weights sum to 1.
std::vector<Part> mixture(const std::vector<const EndsPosterior*>& all, double top) {
  std::vector<Part> parts;
  double sum = 0;
  for (const auto* one : all) {
    for (const auto& answer : one->answers) {
      for (const auto& cell : answer.cells) {
        parts.push_back({std::exp(cell.ln_weight - top), cell.ln_tension, cell_variance(cell)});
        sum += parts.back().weight;
      }
    }
  }
  for (auto& part : parts) part.weight /= sum;
  std::erase_if(parts, [](const Part& part) { return part.weight < 1e-8; });
  return parts;
}

}  // namespace

TensionSummary summarise_tension(const std::vector<const EndsPosterior*>& all) {
  double top = -kUnbounded;
  for (const auto* one : all) top = std::max(top, one->ln_evidence);
  const auto parts = mixture(all, top);
  TensionSummary summary;
  summary.low = mixture_quantile(parts, 0.025);
  summary.high = mixture_quantile(parts, 0.975);
  const double beside = std::log(summary.high / summary.low) / 2 + 1e-6;
  const double from = std::log(summary.low) - beside, to = std::log(summary.high) + beside;
  struct Cell {
    const TensionCell* cell;
    double weight, T;
    std::array<int, 4> group;  // ends, answer, spring, rigidity
  };
  std::vector<Cell> cells;
  double sum = 0, mean = 0, EI = 0, spring = 0;
  for (int ends = 0, answers = 0; ends < static_cast<int>(all.size()); ++ends) {
    for (const auto& answer : all[static_cast<std::size_t>(ends)]->answers) {
      ++answers;
      for (const auto& cell : answer.cells) {
        if (cell.ln_tension < from || cell.ln_tension > to) continue;
        const double w = std::exp(cell.ln_weight - top), T = std::exp(cell.ln_tension);
        cells.push_back({&cell, w, T, {ends, answers, cell.spring, cell.rigidity}});
        sum += w, mean += w * T;
        EI += w * cell.state.EI_Nm2, spring += w * cell.state.spring_Nm_rad;
      }
    }
  }
  mean /= sum, EI /= sum, spring /= sum;
  // Law of total variance: what a level adds is the mean square of its groups' means less that of
  // the level above.
  std::array<double, 6> square{};
  for (std::size_t level = 1; level <= 4; ++level) {
    std::map<std::vector<int>, std::pair<double, double>> groups;  // weight, weighted T - mean
    for (const auto& one : cells) {
      auto& [w, deviation] =
          groups[{one.group.begin(), one.group.begin() + static_cast<std::ptrdiff_t>(level)}];
      w += one.weight, deviation += one.weight * (one.T - mean);
    }
    for (const auto& [key, group] : groups) {
      if (group.first > 0) square[level] += group.second * group.second / group.first / sum;
    }
  }
  double frequencies = 0, models = 0, EI_square = 0, spring_square = 0;
  std::array<double, kCableInputs.size()> inputs{};
  for (const auto& [cell, weight, T, group] : cells) {
    const double w = weight / sum, w_TT = w * T * T, own = cell->state.EI_Nm2;
    square[5] += w * (T - mean) * (T - mean);
    frequencies += w_TT * cell->variance_frequency;
    models += w_TT * cell->variance_model;
    for (std::size_t j = 0; j < inputs.size(); ++j) inputs[j] += w_TT * cell->variance_input[j];
    EI_square += w * ((own - EI) * (own - EI) + own * own * cell->variance_ln_EI);
    spring_square += w * std::pow(cell->state.spring_Nm_rad - spring, 2);
  }
  double variance = 0;
  const auto term = [&](const char* name, double part) {
    variance += std::max(0.0, part);
    // What rounding leaves of a difference of squares is no source.
    if (part > 1e-16 * mean * mean) summary.budget.push_back({name, std::sqrt(part)});
  };
  term("frequencies", frequencies);
  term("model", models + square[5] - square[4]);
  term("EI", square[4] - square[3] + inputs.back());
  term("end springs", square[3] - square[2]);
  term("assignment", square[2] - square[1]);
  term("ends", square[1]);
  for (std::size_t j = 0; j + 1 < inputs.size(); ++j) term(kCableInputs[j], inputs[j]);
  summary.tension = {mean, std::sqrt(variance)};
  summary.EI = {EI, std::sqrt(EI_square)};
  summary.spring = {spring, std::sqrt(spring_square)};
  return summary;
}

}  // namespace rigfit::ident
