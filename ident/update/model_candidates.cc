#include "ident/update/model_candidates.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "ident/update/model_update.h"
#include "ident/update/uncertainty/update_intervals.h"

namespace rigfit::ident {
namespace {

void check(const std::vector<ModelCandidate>& candidates) {
  std::set<std::string> names;
  for (const auto& one : candidates) {
    if (one.name.empty() || !names.insert(one.name).second) {
      throw std::invalid_argument("candidates: every one needs a name of its own");
    }
    std::size_t measured = 0, first = 0;
    for (const auto& state : one.states) {
      if (!state.frfs.empty()) {
        throw std::invalid_argument("candidates: models are compared by modes, not by FRFs");
      }
      measured += state.measured.size();
    }
    for (const auto& state : candidates.front().states) first += state.measured.size();
    if (measured != first) {
      throw std::invalid_argument("candidates: " + one.name + " has other measured modes");
    }
  }
}

const UpdatedParameter* find(const UpdateResult& result, const std::string& name) {
  const auto& all = result.parameters;
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name == name; });
  return found == all.end() ? nullptr : &*found;
}

// The parameters that all have, as alternatives of one result; then its mixture.
std::vector<UpdatedParameter> averaged(const CandidateComparison& comparison) {
  const auto& best = comparison.candidates[static_cast<std::size_t>(comparison.heaviest)];
  UpdateResult mixture;
  mixture.coverage_factor = best.result.coverage_factor;
  for (const auto& one : comparison.candidates) {
    if (!(one.weight > 0)) continue;
    mixture.alternatives.emplace_back();
    mixture.alternatives.back().weight = one.weight;
  }
  for (const auto& parameter : best.result.parameters) {
    std::vector<UpdatedParameter> of_all;
    for (const auto& one : comparison.candidates) {
      if (!(one.weight > 0)) continue;
      const auto* same = find(one.result, parameter.name);
      if (same != nullptr) of_all.push_back(*same);
    }
    if (of_all.size() != mixture.alternatives.size()) continue;
    double mean = 0, square = 0;
    for (std::size_t k = 0; k < of_all.size(); ++k) {
      const double weight = mixture.alternatives[k].weight;
      mean += weight * of_all[k].value;
      square += weight * (std::pow(of_all[k].value, 2) + std::pow(of_all[k].std, 2));
      mixture.alternatives[k].parameters.push_back(of_all[k]);
    }
    mixture.parameters.push_back(parameter);
    auto& all = mixture.parameters.back();
    all.value = mean;
    all.std = std::sqrt(std::max(0.0, square - mean * mean));
    all.budget.clear();
  }
  state_mixture(mixture);
  return mixture.parameters;
}

}  // namespace

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
    const double ln = one.result.log_evidence;
    one.weight = std::isfinite(ln) ? std::exp(ln - most) : 0;
    sum += one.weight;
  }
  for (auto& one : comparison.candidates) one.weight /= sum;
  comparison.averaged = averaged(comparison);
  return comparison;
}

}  // namespace rigfit::ident
