// Assignments of a problem's measured modes to its modelled ones; residuals of the pairs
// (frequencies and damping ratios), then what update_frfs.cc adds, then priors.
#include <fmt/format.h>

#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {

UpdateMatches UpdateProblem::assign_state(int s, const UpdateStateModes& modelled) const {
  const auto& state = state_at(s);
  std::vector<PairingMode> measured;
  const std::vector<PairingMode> model(modelled.modes.begin(), modelled.modes.end());
  std::vector<double> stds;
  for (std::size_t m = 0; m < state.measured.size(); ++m) {
    const auto& mode = state.measured[m];
    measured.push_back({.frequency_hz = mode.frequency_hz.value,
                        .plane = mode.plane,
                        .shape = mode.shape,
                        .order = mode.order});
    stds.push_back(relative_std(s, static_cast<int>(m)));
  }
  const ModeAssignment found =
      assign_modes(measured, stds, model, state.band_hz, options_.assignment);
  UpdateMatches result;
  result.add(found);
  for (const auto& pair : found.pairs) {
    const auto& mode = modelled.modes[static_cast<std::size_t>(pair.model)];
    result.matches.push_back(
        {s, pair.measured, *mode.plane, mode.order - 1, pair.mac, pair.cross_plane});
  }
  for (const int index : found.unpaired_measured) {
    UpdatedPair& alone = result.unpaired.emplace_back(UpdatedPair{{s, index}, state.name});
    alone.measured_hz = measured[static_cast<std::size_t>(index)].frequency_hz;
    alone.reason = "no mode of the model explains it";
  }
  for (const auto& missed : found.missed) {
    const auto& mode = modelled.modes[static_cast<std::size_t>(missed.model)];
    UpdatedPair& alone = result.unpaired.emplace_back(UpdatedPair{{s}, state.name});
    alone.model_hz = mode.frequency_hz;
    alone.reason =
        fmt::format("{} {}: the test should have seen it", model::name_of(*mode.plane), mode.order);
  }
  return result;
}

UpdateMatches UpdateProblem::assign(const VectorXd& q, std::string& failure, bool scaled) const {
  constexpr double kStep = 0.1, kReach = 0.7;  // ln f: see update_alternatives.h
  UpdateMatches all;
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    const auto& state = state_at(s);
    if (!takes_part(s) || state.measured.empty()) continue;
    UpdateStateModes modelled = modes(s, q, false);
    if (!modelled.failure.empty()) {
      failure = (state.name.empty() ? "" : state.name + ": ") + modelled.failure;
      return {};
    }
    UpdateMatches best = assign_state(s, modelled);
    double at = 0;
    for (double to = -kReach; scaled && to < kReach + 0.5 * kStep; to += kStep) {
      for (auto& mode : modelled.modes) mode.frequency_hz *= std::exp(to - at);
      at = to;
      UpdateMatches one = assign_state(s, modelled);
      if (one.log_likelihood > best.log_likelihood) best = std::move(one);
    }
    all.append(best);
  }
  return all;
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
  return std::ranges::any_of(states_, [](const auto& state) { return !state.measured.empty(); });
}

bool UpdateProblem::has_frfs() const {
  return std::ranges::any_of(states_, [](const auto& state) { return !state.frfs.empty(); });
}

std::vector<UpdateProblem::FrequencyRow> UpdateProblem::frequency_rows(
    const std::vector<UpdateMatch>& matches) const {
  std::vector<FrequencyRow> rows;
  Index row = 2 * frf_lines();
  for (std::size_t m = 0; m < matches.size(); ++m) {
    const auto& match = matches[m];
    if (match.cross_plane || state_at(match.state).modes_lead_only) {
      continue;
    }
    const bool damping = damping_fitted(measured(match.state, match.measured));
    rows.push_back({row, damping ? row + 1 : -1, m});
    row += damping ? 2 : 1;
  }
  return rows;
}

Index UpdateProblem::residual_count(const std::vector<UpdateMatch>& matches) const {
  Index count = priors_ + 2 * frf_lines();
  for (const auto& row : frequency_rows(matches)) count += row.damping < 0 ? 1 : 2;
  return count;
}

bool UpdateProblem::residuals(const VectorXd& q, const std::vector<UpdateMatch>& matches,
                              VectorXd& r, MatrixXd* jacobian) const {
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
  Index prior = r.size() - priors_;
  for (Index j = 0; j < size(); ++j) {
    const auto& coordinate = coordinate_at(j);
    if (coordinate.prior_std <= 0) continue;
    r[prior] = (q[j] - coordinate.prior) / coordinate.prior_std;
    if (jacobian != nullptr) (*jacobian)(prior, j) = 1 / coordinate.prior_std;
    ++prior;
  }
  return r.allFinite() && (jacobian == nullptr || jacobian->allFinite());
}

bool UpdateProblem::is_moved(int state, const std::string& target, Index count) const {
  return std::any_of(coordinates_.begin(), coordinates_.begin() + count, [&](const auto& one) {
    return std::ranges::any_of(one.effects, [&](const auto& effect) {
      return effect.state == state && effect.target == target;
    });
  });
}

}  // namespace rigfit::ident
