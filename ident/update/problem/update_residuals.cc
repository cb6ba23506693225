// Residuals of the update: frequencies and damping ratios of pairs, then what
// update_frfs.cc adds, then priors.
#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {

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

std::vector<UpdateProblem::FrequencyRow> UpdateProblem::frequency_rows(
    const std::vector<UpdateMatch>& matches) const {
  std::vector<FrequencyRow> rows;
  Eigen::Index row = 2 * frf_lines();
  for (std::size_t m = 0; m < matches.size(); ++m) {
    const auto& match = matches[m];
    if (match.cross_plane || states_[static_cast<std::size_t>(match.state)].modes_lead_only) {
      continue;
    }
    const bool damping = damping_fitted(measured(match.state, match.measured));
    rows.push_back({row, damping ? row + 1 : -1, m});
    row += damping ? 2 : 1;
  }
  return rows;
}

Eigen::Index UpdateProblem::residual_count(const std::vector<UpdateMatch>& matches) const {
  Eigen::Index count = priors_ + 2 * frf_lines();
  for (const auto& row : frequency_rows(matches)) count += row.damping < 0 ? 1 : 2;
  return count;
}

bool UpdateProblem::residuals(const Eigen::VectorXd& q, const std::vector<UpdateMatch>& matches,
                              Eigen::VectorXd& r, Eigen::MatrixXd* jacobian) const {
  r.setZero(residual_count(matches));
  if (jacobian != nullptr) jacobian->setZero(r.size(), size());
  int current = -1;
  UpdateStateModes modelled;
  for (const auto& row : frequency_rows(matches)) {
    const auto& match = matches[row.match];  // ordered by state
    if (match.state != current) {
      modelled = modes(match.state, q, jacobian != nullptr, &matches);
      if (!modelled.failure.empty()) return false;
      current = match.state;
    }
    const UpdateModelMode* mode = modelled.find(match.plane, match.order);
    if (mode == nullptr) return false;
    const auto& found = measured(match.state, match.measured);
    const double std = relative_std(match.state, match.measured);
    const double factor = measured_factor(match.state, q);
    r[row.row] = std::log(mode->frequency_hz / (found.frequency_hz.value * factor)) / std;
    if (jacobian != nullptr) {
      jacobian->row(row.row) = mode->dlog_frequency / std;
      for (const auto& [j, change] : rate_changes(match.state)) {
        (*jacobian)(row.row, j) -= change / (factor * std);
      }
    }
    if (row.damping < 0) continue;
    if (!known(mode->damping_ratio)) return false;
    const double damping_std = damping_relative_std(match.state, match.measured);
    r[row.damping] = std::log(mode->damping_ratio / found.damping_ratio.value) / damping_std;
    if (jacobian != nullptr) jacobian->row(row.damping) = mode->dlog_damping / damping_std;
  }
  const auto frfs = frf_rows();
  if (!frf_residuals(q, frfs, r, jacobian)) return false;
  add_force_noise(q, frfs, r, jacobian);
  Eigen::Index prior = r.size() - priors_;
  for (Eigen::Index j = 0; j < size(); ++j) {
    const auto& coordinate = coordinates_[static_cast<std::size_t>(j)];
    if (coordinate.prior_std <= 0) continue;
    r[prior] = (q[j] - coordinate.prior) / coordinate.prior_std;
    if (jacobian != nullptr) (*jacobian)(prior, j) = 1 / coordinate.prior_std;
    ++prior;
  }
  return r.allFinite() && (jacobian == nullptr || jacobian->allFinite());
}

bool UpdateProblem::is_moved(int state, const std::string& target, Eigen::Index count) const {
  return std::any_of(coordinates_.begin(), coordinates_.begin() + count, [&](const auto& one) {
    return std::ranges::any_of(one.effects, [&](const auto& effect) {
      return effect.state == state && effect.target == target;
    });
  });
}

}  // namespace rigfit::ident
