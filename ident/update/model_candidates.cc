#include "ident/update/model_candidates.h"

#include "ident/update/assignment/update_alternatives.h"
#include "ident/update/model_update.h"
#include "ident/update/uncertainty/update_uncertainty.h"

namespace rigfit::ident {
namespace {

void check(const std::vector<ModelCandidate>& candidates) {
  const auto measured = [](const ModelCandidate& one) {
    std::size_t modes = 0;
    for (const auto& state : one.states) modes += state.measured.size();
    return modes;
  };
  std::set<std::string> names;
  for (const auto& one : candidates) {
    if (one.name.empty() || !names.insert(one.name).second) {
      throw std::invalid_argument("candidates: every one needs a name of its own");
    }
    if (std::ranges::any_of(one.states, [](const auto& state) { return !state.frfs.empty(); })) {
      throw std::invalid_argument("candidates: models are compared by modes, not by FRFs");
    }
    if (measured(one) != measured(candidates.front())) {
      throw std::invalid_argument("candidates: " + one.name + " has other measured modes");
    }
  }
}

// The parameters that all have, over the answers of all as alternatives of one result.
std::vector<UpdatedParameter> averaged(const CandidateComparison& comparison) {
  const auto& best = comparison.candidates[static_cast<std::size_t>(comparison.heaviest)];
  UpdateResult mixture;
  mixture.coverage_factor = best.result.coverage_factor;
  const auto answers = answers_of(comparison);
  for (const auto& one : answers) {
    mixture.alternatives.emplace_back();
    mixture.alternatives.back().weight = one.weight;
  }
  for (const auto& parameter : best.result.parameters) {
    const bool common = std::all_of(answers.begin(), answers.end(), [&](const auto& one) {
      return find(one.parameters, parameter.name) != nullptr;
    });
    if (!common) continue;
    mixture.parameters.push_back(parameter);
    for (std::size_t k = 0; k < answers.size(); ++k) {
      mixture.alternatives[k].parameters.push_back(*find(answers[k].parameters, parameter.name));
    }
  }
  state_mixture(mixture);
  for (std::size_t p = 0; p < mixture.parameters.size(); ++p) {
    auto& all = mixture.parameters[p];
    const double beside = (all.high - all.low) / 2;
    double sum = 0, mean = 0, square = 0;
    for (const auto& one : mixture.alternatives) {
      const auto& own = one.parameters[p];
      if (own.value < all.low - beside || own.value > all.high + beside) continue;
      sum += one.weight;
      mean += one.weight * own.value;
      const double std = std::isfinite(own.std) ? own.std : std::abs(own.value);
      square += one.weight * (own.value * own.value + std * std);
    }
    all.value = mean / sum;
    all.std = std::sqrt(std::max(0.0, square / sum - all.value * all.value));
    all.budget.clear();
  }
  return mixture.parameters;
}

}  // namespace

std::vector<UpdateAlternative> answers_of(const CandidateComparison& comparison) {
  std::vector<UpdateAlternative> answers;
  for (const auto& candidate : comparison.candidates) {
    if (!(candidate.weight > 0)) continue;
    for (auto answer : candidate.result.alternatives) {
      answer.weight *= candidate.weight;
      answers.push_back(std::move(answer));
    }
  }
  return answers;
}

CandidateComparison compare_candidates(const std::vector<ModelCandidate>& candidates,
                                       const UpdateOptions& options) {
  if (candidates.empty()) throw std::invalid_argument("candidates: none");
  check(candidates);
  CandidateComparison comparison;
  double most = -std::numeric_limits<double>::infinity();
  for (const auto& candidate : candidates) {
    FittedCandidate one{candidate.name, update_model(candidate.states, candidate.free, options), 0};
    if (one.result.status != UpdateStatus::no_model && one.result.log_evidence > most) {
      most = one.result.log_evidence;
      comparison.heaviest = static_cast<int>(comparison.candidates.size());
    }
    comparison.candidates.push_back(std::move(one));
  }
  if (comparison.heaviest < 0) return comparison;
  double sum = 0;
  for (auto& one : comparison.candidates) {
    const double less = most - one.result.log_evidence;
    one.weight = std::isfinite(less) && less < kNegligible ? std::exp(-less) : 0;
    sum += one.weight;
  }
  for (auto& one : comparison.candidates) one.weight /= sum;
  comparison.averaged = averaged(comparison);
  return comparison;
}

const UpdatedParameter* find(const std::vector<UpdatedParameter>& all, const std::string& name) {
  const auto found = std::ranges::find(all, name, &UpdatedParameter::name);
  return found == all.end() ? nullptr : &*found;
}

}  // namespace rigfit::ident
