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
constexpr double kNegligible = 18;  // in ln(weight)

double ln_sum(const std::vector<TensionCell>& cells) {
  double top = -kUnbounded, sum = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) top = std::max(top, cells[i].ln_weight);
  if (!std::isfinite(top)) return -kUnbounded;
  for (std::size_t i = 0; i < cells.size(); ++i) sum += std::exp(cells[i].ln_weight - top);
  return top + std::log(sum);
}

/// Distance in ln x and ln q.
double apart(const CableShape& a, const CableShape& b) {
  const auto ln = [](double q) { return std::log(std::clamp(q, kRangeOfQ.low, kRangeOfQ.high)); };
  return std::abs(std::log(a.x / b.x)) + std::abs(ln(a.q) - ln(b.q));
}

/// Centres of the densities of EI and springs, the nearest to a shape first.
std::vector<CableShape> centres(const CableDescription& cable, CableEnds ends,
                                const CableShape& near) {
  const bool springs = ends == CableEnds::springs;
  std::vector<CableShape> shapes;
  for (int k = 0; k < (cable.EI_Nm2 ? 1 : kRangeOfX.count); ++k) {
    for (int i = 0; i < (springs ? kRangeOfQ.count : 1); ++i) {
      shapes.push_back({kRangeOfX.centre(k),
                        springs                     ? kRangeOfQ.centre(i)
                        : ends == CableEnds::pinned ? 0
                                                    : kUnbounded,
                        ends == CableEnds::pinned_clamped});
    }
  }
  const auto order = [&](const auto& a, const auto& b) { return apart(a, near) < apart(b, near); };
  std::stable_sort(shapes.begin(), shapes.end(), order);
  return shapes;
}

}  // namespace

bool EI_is_exact(const CableDescription& cable) {
  return cable.EI_Nm2 && !(cable.EI_Nm2->std > 0 && cable.EI_Nm2->value > 0);
}

TensionAnswer tension_answer(const CableModel& model, const TensionData& data, CableEnds ends,
                             const Assignment& assignment, double ln_evidence_of_best) {
  TensionAnswer answer;
  answer.modes = assignment.modes;
  TensionFit local(model, data, answer.modes, ends == CableEnds::springs);
  if (local.pairs() == 0) return answer;
  const auto shapes = centres(model.cable(), ends, assignment.shape);
  const double ln_prior = -std::log(static_cast<double>(shapes.size()));
  std::vector<TensionCell> solved;  // a cell of each centre, from which its neighbours start
  double top = -kUnbounded, ln_assigned = 0;
  const auto assigned_at = [&](const CableState& state) {
    std::vector<TensionData::Listed> listed;
    data.list(model.frequencies(state, 200, 1.05 * data.highest_hz), listed);
    return data.ln_assigned(answer.modes, listed);
  };
  for (const auto& shape : shapes) {
    // What is far below the best answer about the nearest centres needs no others.
    if (solved.size() > shapes.size() / 4 &&
        top + ln_assigned < ln_evidence_of_best - 2 * kNegligible) {
      break;
    }
    auto start = state_of(model.cable(), shape, std::exp(assignment.ln_tension));
    start.EA = assignment.EA;
    const auto nearest =
        std::min_element(solved.begin(), solved.end(), [&](const auto& a, const auto& b) {
          return apart(a.shape, shape) < apart(b.shape, shape);
        });
    if (!(nearest != solved.end() && local.fit(nearest->state, shape)) &&
        !local.fit(start, shape)) {
      continue;
    }
    if (solved.empty()) ln_assigned = assigned_at(local.state());
    solved.push_back({});
    solved.back().state = local.state(), solved.back().shape = shape;
    local.add_cells(ln_prior, answer.cells);
    for (const auto& cell : answer.cells) top = std::max(top, cell.ln_weight);
  }
  std::erase_if(answer.cells,
                [top](const auto& cell) { return !(cell.ln_weight > top - kNegligible); });
  if (answer.cells.empty()) return answer;
  answer.best = static_cast<std::size_t>(
      std::max_element(answer.cells.begin(), answer.cells.end(),
                       [](const auto& a, const auto& b) { return a.ln_weight < b.ln_weight; }) -
      answer.cells.begin());
  ln_assigned = assigned_at(answer.state());
  for (auto& cell : answer.cells) cell.ln_weight += ln_assigned;
  answer.ln_evidence = ln_sum(answer.cells);
  return answer;
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
    std::array<double, 4> group;  // ends, answer, spring, rigidity
  };
  std::vector<Cell> cells;
  double sum = 0, mean = 0, EI = 0, spring = 0;
  double ends = 0, answers = 0;
  for (const auto* one : all) {
    ++ends;
    for (const auto& answer : one->answers) {
      ++answers;
      for (const auto& cell : answer.cells) {
        if (cell.ln_tension < from || cell.ln_tension > to) continue;
        const double w = std::exp(cell.ln_weight - top), T = std::exp(cell.ln_tension);
        cells.push_back({&cell, w, T, {ends, answers, cell.shape.q, cell.shape.x}});
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
    std::map<std::vector<double>, std::pair<double, double>> groups;  // weight, weighted T - mean
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
    EI_square += w * ((own - EI) * (own - EI) + own * own * cell->variance_ln[6]);
    const double k = cell->state.spring_Nm_rad;
    spring_square += w * ((k - spring) * (k - spring) + k * k * cell->variance_ln[7]);
  }
  double variance = 0;
  const auto term = [&](const char* name, double part) {
    variance += std::max(0.0, part);
    // What rounding leaves of a difference of squares is no source.
    if (part > 1e-16 * mean * mean) summary.budget.push_back({name, std::sqrt(part)});
  };
  term("frequencies", frequencies);
  term("model", models + square[5] - square[4]);
  term("EI", square[4] - square[3] + inputs[6]);
  term("end springs", square[3] - square[2] + inputs[7]);
  term("assignment", square[2] - square[1]);
  term("ends", square[1]);
  for (std::size_t j = 0; j < 6; ++j) term(kCableInputs[j], inputs[j]);
  summary.tension = {mean, std::sqrt(variance)};
  summary.EI = {EI, std::sqrt(EI_square)};
  summary.spring = {spring, std::sqrt(spring_square)};
  return summary;
}

}  // namespace rigfit::ident
