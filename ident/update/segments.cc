#include "ident/update/segments.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

namespace rigfit::ident {
namespace {

bool has_members(const Likelihood& likelihood, int state, bool given) {
  for (int s = 0; s < static_cast<int>(likelihood.states().size()); ++s) {
    if (state >= 0 && s != state) continue;
    const auto& members = likelihood.states()[static_cast<std::size_t>(s)].scene.members;
    const bool found = std::any_of(members.begin(), members.end(), [&](const auto& member) {
      return (member.segments != 0) == given;
    });
    if (found) return true;
  }
  return false;
}

}  // namespace

bool has_given_segments(const Likelihood& likelihood, int state) {
  return has_members(likelihood, state, true);
}

bool change_by_segments(const Likelihood& likelihood, const std::vector<UpdateMatch>& matches,
                        const Eigen::VectorXd& q, Eigen::VectorXd& change) {
  change = Eigen::VectorXd::Zero(likelihood.residual_count(matches, UpdateStage::full));
  if (!has_given_segments(likelihood, -1) && !likelihood.has_frfs()) return true;
  Likelihood once = likelihood, twice = likelihood;
  once.mesh.errors = nullptr;
  twice.mesh.factor *= 2;
  Eigen::VectorXd r, finer;
  if (!once.residuals(q, matches, UpdateStage::full, r, nullptr) ||
      !twice.residuals(q, matches, UpdateStage::full, finer, nullptr)) {
    return false;
  }
  change = kOfHalving * (r - finer);
  for (const auto& row : likelihood.frequency_rows(matches, UpdateStage::full)) {
    if (!has_given_segments(likelihood, matches[row.match].state)) change[row.row] = 0;
  }
  return true;
}

void take_segments_off(Likelihood& likelihood, UpdateSolution& answer, int passes) {
  constexpr double kShare = 0.05, kLeast = 1e-8;
  if (!likelihood.options().segment_uncertainty || !has_members(likelihood, -1, false)) return;
  const auto states = static_cast<int>(likelihood.states().size());
  double best = 1;
  for (int s = 0; s < states; ++s) {
    const auto& state = likelihood.states()[static_cast<std::size_t>(s)];
    for (int m = 0; m < static_cast<int>(state.measured.size()); ++m) {
      best = std::min(best, likelihood.relative_std(s, m));
    }
  }
  for (int pass = 0; pass < passes; ++pass) {
    Likelihood trial = likelihood;
    trial.mesh.errors = nullptr;
    auto errors = std::make_shared<std::vector<std::vector<Mesh::ModeError>>>(states);
    bool any = false;
    for (int s = 0; s < states; ++s) {
      const auto& state = trial.states()[static_cast<std::size_t>(s)];
      if (state.measured.empty() || state.modes_lead_only || !has_members(trial, s, false)) {
        continue;
      }
      const auto here = trial.modes(s, answer.q, false);
      if (!here.failure.empty()) continue;
      model::Scene scene = trial.scene_at(s, answer.q);
      scene.accuracy = std::clamp(kShare * best, kLeast, scene.accuracy);
      model::ModesOptions options;
      options.count = static_cast<int>(here.modes.size());
      options.shapes = false;
      std::map<model::ModePlane, int> seen;
      for (const auto& mode : model::analyse_modes(scene, options).modes) {
        if (!known(mode.frequency_hz)) continue;
        const int order = seen[mode.plane]++;
        const auto* rough = here.find(mode.plane, order);
        if (rough == nullptr) continue;
        (*errors)[static_cast<std::size_t>(s)].push_back(
            {mode.plane, order, std::log(rough->frequency_hz / mode.frequency_hz)});
        any = true;
      }
    }
    if (!any) return;
    trial.mesh.errors = std::move(errors);
    Eigen::VectorXd q = answer.q;
    double cost = 0;
    if (!minimise(trial, answer.matches.matches, UpdateStage::full, likelihood.options(), q,
                  cost)) {
      return;
    }
    answer.q = std::move(q);
    likelihood = std::move(trial);
  }
}

double segment_excess(const Likelihood& likelihood, const std::vector<UpdateMatch>& matches,
                      const UpdateResult& result) {
  constexpr double kSmall = 0.2;
  double excess = 0;
  for (const auto& parameter : result.parameters) {
    if (!parameter.identifiable || !std::isfinite(parameter.segment_shift)) continue;
    const double all = parameter.std * parameter.std,
                 own = parameter.segment_shift * parameter.segment_shift;
    const double small = kSmall * std::sqrt(std::max(all - own, 1e-6 * own));
    if (own > 0) excess = std::max(excess, std::sqrt(own) / small);
  }
  Eigen::VectorXd change;
  if (!change_by_segments(likelihood, matches, result.coordinates, change)) return excess;
  const double verdict = kSmall * std::sqrt(2 * std::max(1.0, result.degrees_of_freedom));
  return std::max(excess, std::sqrt(change.squaredNorm() / verdict));
}

}  // namespace rigfit::ident
