// Residuals of the update: frequencies and damping ratios of pairs, then what
// update_frfs.cc adds, then priors.
#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {

bool UpdateProblem::counts(int state) const {
  return !states_[static_cast<std::size_t>(state)].modes_lead_only;
}

UpdateProblem UpdateProblem::modes_alone() const {
  UpdateProblem other = *this;
  for (auto& state : other.states_) {
    state.frfs.clear();
    state.modes_lead_only = false;
  }
  return other;
}

bool UpdateProblem::has_modes() const {
  return std::any_of(states_.begin(), states_.end(),
                     [](const auto& state) { return !state.measured.empty(); });
}

bool UpdateProblem::has_frfs() const {
  return std::any_of(states_.begin(), states_.end(),
                     [](const auto& state) { return !state.frfs.empty(); });
}

Eigen::Index UpdateProblem::residual_count(const std::vector<UpdateMatch>& matches) const {
  Eigen::Index count = priors_;
  for (const auto& match : matches) {
    if (match.cross_plane || !counts(match.state)) continue;
    const auto& mode = states_[static_cast<std::size_t>(match.state)]
                           .measured[static_cast<std::size_t>(match.measured)];
    count += damping_fitted(mode) ? 2 : 1;
  }
  return count + 2 * frf_lines();
}

bool UpdateProblem::residuals(const Eigen::VectorXd& q, const std::vector<UpdateMatch>& matches,
                              Eigen::VectorXd& r, Eigen::MatrixXd* jacobian) const {
  r.setZero(residual_count(matches));
  if (jacobian != nullptr) jacobian->setZero(r.size(), size());
  Eigen::Index row = 0;
  int current = -1;
  UpdateStateModes modelled;
  for (const auto& match : matches) {  // ordered by state
    if (match.cross_plane || !counts(match.state)) continue;
    if (match.state != current) {
      modelled = modes(match.state, q, jacobian != nullptr, &matches);
      if (!modelled.failure.empty()) return false;
      current = match.state;
    }
    const UpdateModelMode* mode = modelled.find(match.plane, match.order);
    if (mode == nullptr) return false;
    const auto& measured = states_[static_cast<std::size_t>(match.state)]
                               .measured[static_cast<std::size_t>(match.measured)];
    const double std = relative_std(match.state, match.measured);
    const double factor = measured_factor(match.state, q);
    r[row] = std::log(mode->frequency_hz / (measured.frequency_hz.value * factor)) / std;
    if (jacobian != nullptr) {
      jacobian->row(row) = mode->dlog_frequency / std;
      for (const auto& [j, change] : rate_changes(match.state)) {
        (*jacobian)(row, j) -= change / (factor * std);
      }
    }
    ++row;
    if (damping_fitted(measured)) {
      if (!known(mode->damping_ratio)) return false;
      const double damping_std = damping_relative_std(match.state, match.measured);
      r[row] = std::log(mode->damping_ratio / measured.damping_ratio.value) / damping_std;
      if (jacobian != nullptr) jacobian->row(row) = mode->dlog_damping / damping_std;
      ++row;
    }
  }
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    if (!takes_part(s)) continue;
    if (!frf_residuals(s, q, row, r, jacobian)) return false;
  }
  add_force_noise(q, matches, r, jacobian);
  for (Eigen::Index j = 0; j < size(); ++j) {
    const auto& coordinate = coordinates_[static_cast<std::size_t>(j)];
    if (coordinate.prior_std <= 0) continue;
    r[row] = (q[j] - coordinate.prior) / coordinate.prior_std;
    if (jacobian != nullptr) (*jacobian)(row, j) = 1 / coordinate.prior_std;
    ++row;
  }
  return r.allFinite() && (jacobian == nullptr || jacobian->allFinite());
}

bool UpdateProblem::is_free(int state, const std::string& target) const {
  return present_[static_cast<std::size_t>(state)].contains(target) &&
         std::any_of(free_.begin(), free_.end(), [&](const FreeParameter& parameter) {
           return std::count(parameter.targets.begin(), parameter.targets.end(), target) > 0;
         });
}

bool UpdateProblem::is_stated(int state, const std::string& target) const {
  for (const auto& parameter : free_) {
    if (std::count(parameter.targets.begin(), parameter.targets.end(), target) > 0) return true;
  }
  for (const auto& input : options_.inputs) {
    for (const auto& effect : input.effects) {
      if (effect.state == state && effect.target == target) return true;
    }
  }
  return false;
}

}  // namespace rigfit::ident
