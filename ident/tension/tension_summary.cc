#include "ident/tension/tension_summary.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace rigfit::ident {
namespace {

using signal::Estimate;

constexpr double kNever = std::numeric_limits<double>::infinity();

/// A weighted normal of ln T, and where it comes from.
struct Part {
  double weight = 0, ln_tension = 0, variance = 0;
};

double mixture_quantile(const std::vector<Part>& parts, double probability) {
  double low = kNever, high = -kNever;
  for (const auto& part : parts) {
    const double reach = 8 * std::sqrt(part.variance) + 1e-12;
    low = std::min(low, part.ln_tension - reach);
    high = std::max(high, part.ln_tension + reach);
  }
  for (int i = 0; i < 60 && high - low > 1e-10; ++i) {
    const double middle = (low + high) / 2;
    double below = 0;
    for (const auto& part : parts) {
      below +=
          part.weight * 0.5 * std::erfc((part.ln_tension - middle) / std::sqrt(2 * part.variance));
    }
    (below < probability ? low : high) = middle;
  }
  return std::exp((low + high) / 2);
}

class TensionMoments {
 public:
  void add(double weight, double value) {
    if (!(weight > 0)) return;
    weight_ += weight;
    mean_ += weight * value;
    square_ += weight * value * value;
  }
  [[nodiscard]] double weight() const { return weight_; }
  [[nodiscard]] double mean() const { return weight_ > 0 ? mean_ / weight_ : 0; }
  [[nodiscard]] double variance() const {
    return weight_ > 0 ? std::max(0.0, square_ / weight_ - mean() * mean()) : 0;
  }

 private:
  double weight_ = 0, mean_ = 0, square_ = 0;
};

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
  double top = -kNever;
  for (const auto* one : all) top = std::max(top, one->ln_evidence);
  const auto parts = mixture(all, top);
  TensionSummary summary;
  summary.low = mixture_quantile(parts, 0.025);
  summary.high = mixture_quantile(parts, 0.975);
  const double beside = std::log(summary.high / summary.low) / 2 + 1e-6;
  const double from = std::log(summary.low) - beside, to = std::log(summary.high) + beside;
  const double reference = all.front()->answers.front().cells.front().ln_tension;
  const double scale = std::exp(reference);
  TensionMoments total, EI, spring, ends;
  double assignments = 0, springs = 0, rigidities = 0, models = 0, frequencies = 0, within_EI = 0;
  std::map<std::string, double> inputs;
  for (const auto* one : all) {
    TensionMoments of_ends, of_answers;
    for (const auto& answer : one->answers) {
      TensionMoments of_answer;
      std::map<int, std::map<int, TensionMoments>> by_spring;
      for (const auto& cell : answer.cells) {
        if (cell.ln_tension < from || cell.ln_tension > to) continue;
        const double w = std::exp(cell.ln_weight - top);
        const double T = std::exp(cell.ln_tension - reference);
        for (std::size_t j = 0; j < kCableInputs.size(); ++j) {
          inputs[kCableInputs[j]] += w * T * T * cell.variance_input[j];
        }
        for (TensionMoments* moments :
             {&total, &of_ends, &of_answer, &by_spring[cell.spring][cell.rigidity]}) {
          moments->add(w, T);
        }
        EI.add(w, cell.state.EI_Nm2);
        within_EI += w * cell.state.EI_Nm2 * cell.state.EI_Nm2 * cell.variance_ln_EI;
        spring.add(w, cell.state.spring_Nm_rad);
        frequencies += w * T * T * cell.variance_frequency;
        models += w * T * T * cell.variance_model;
      }
      of_answers.add(of_answer.weight(), of_answer.mean());
      TensionMoments between;
      for (const auto& [spring_index, of_spring] : by_spring) {
        TensionMoments within;
        for (const auto& [index, moments] : of_spring) {
          within.add(moments.weight(), moments.mean());
          models += moments.weight() * moments.variance();
        }
        between.add(within.weight(), within.mean());
        rigidities += within.weight() * within.variance();
      }
      springs += between.weight() * between.variance();
    }
    assignments += of_answers.weight() * of_answers.variance();
    ends.add(of_ends.weight(), of_ends.mean());
  }
  const double mean = total.mean() * scale;
  double variance = 0;
  const auto term = [&](const std::string& name, double weighted) {
    const double part = weighted / total.weight() * scale * scale;
    variance += part;
    // What rounding leaves of a difference of squares is no source.
    if (part > 1e-24 * mean * mean) summary.budget.push_back({name, std::sqrt(part)});
  };
  term("frequencies", frequencies);
  term("model", models);
  const auto of_EI = inputs.find("EI");
  term("EI", rigidities + (of_EI == inputs.end() ? 0 : of_EI->second));
  inputs.erase("EI");
  term("end springs", springs);
  term("assignment", assignments);
  term("ends", ends.weight() * ends.variance());
  for (const auto& [name, weighted] : inputs) term(name, weighted);
  summary.tension = {mean, std::sqrt(variance)};
  summary.EI = {EI.mean(), std::sqrt(EI.variance() + within_EI / EI.weight())};
  summary.spring = {spring.mean(), std::sqrt(spring.variance())};
  return summary;
}

}  // namespace rigfit::ident
