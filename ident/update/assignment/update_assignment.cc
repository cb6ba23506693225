// Assignments of a problem's measured modes to its modelled ones, and the model's error in them.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {

UpdateProblem UpdateProblem::with_model_std(double frequency, double damping) const {
  UpdateProblem other = *this;
  other.variant_.model_std = frequency;
  other.variant_.damping_model_std = damping;
  return other;
}

std::vector<UpdateProblem::FrequencyRow> UpdateProblem::frequency_rows(
    const std::vector<UpdateMatch>& matches) const {
  std::vector<FrequencyRow> rows;
  Eigen::Index row = 0;
  for (std::size_t m = 0; m < matches.size(); ++m) {
    const auto& match = matches[m];
    if (match.cross_plane || !counts(match.state)) continue;
    const auto& mode = states_[static_cast<std::size_t>(match.state)]
                           .measured[static_cast<std::size_t>(match.measured)];
    const bool damping = damping_fitted(mode);
    rows.push_back({row, damping ? row + 1 : -1, m});
    row += damping ? 2 : 1;
  }
  return rows;
}

UpdateMatches UpdateProblem::assign_state(int s, const UpdateStateModes& modelled) const {
  const auto& state = states_[static_cast<std::size_t>(s)];
  std::vector<PairingMode> measured, model;
  std::vector<double> stds;
  for (std::size_t m = 0; m < state.measured.size(); ++m) {
    const auto& mode = state.measured[m];
    measured.push_back({.frequency_hz = mode.frequency_hz.value,
                        .plane = mode.plane,
                        .shape = mode.shape,
                        .order = mode.order});
    stds.push_back(relative_std(s, static_cast<int>(m)));
  }
  for (const auto& mode : modelled.modes) {
    model.push_back({.frequency_hz = mode.frequency_hz,
                     .plane = mode.plane,
                     .shape = mode.shape,
                     .visibility = mode.visibility,
                     .order = mode.order + 1});
  }
  const ModeAssignment found =
      assign_modes(measured, stds, model, state.band_hz, options_.assignment);
  UpdateMatches result;
  result.add(found);
  for (const auto& pair : found.pairs) {
    const auto& mode = modelled.modes[static_cast<std::size_t>(pair.model)];
    result.matches.push_back(
        {s, pair.measured, mode.plane, mode.order, pair.mac, pair.cross_plane});
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
    alone.reason = fmt::format("{} {}: the test should have seen it", model::name_of(mode.plane),
                               mode.order + 1);
  }
  return result;
}

template <class AssignModes>
UpdateMatches UpdateProblem::assigned(const Eigen::VectorXd& q, std::string& failure, int only,
                                      const AssignModes& assign_modes) const {
  UpdateMatches all;
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    if (only >= 0 ? s != only : !takes_part(s)) continue;
    const auto& state = states_[static_cast<std::size_t>(s)];
    if (state.measured.empty()) continue;
    UpdateStateModes modelled = modes(s, q, false);
    if (!modelled.failure.empty()) {
      failure = (state.name.empty() ? "" : state.name + ": ") + modelled.failure;
      return {};
    }
    all.append(assign_modes(s, modelled));
  }
  return all;
}

UpdateMatches UpdateProblem::assign(const Eigen::VectorXd& q, std::string& failure,
                                    int only) const {
  return assigned(q, failure, only,
                  [this](int s, const auto& modelled) { return assign_state(s, modelled); });
}

UpdateMatches UpdateProblem::assign_scaled(const Eigen::VectorXd& q, std::string& failure) const {
  constexpr double kStep = 0.1, kReach = 0.7;  // ln f: see update_alternatives.h
  return assigned(q, failure, -1, [this](int s, UpdateStateModes& modelled) {
    UpdateMatches best;
    best.log_likelihood = -std::numeric_limits<double>::infinity();
    double at = 0;
    for (double to = -kReach; to < kReach + 0.5 * kStep; to += kStep) {
      for (auto& mode : modelled.modes) mode.frequency_hz *= std::exp(to - at);
      at = to;
      UpdateMatches one = assign_state(s, modelled);
      if (one.log_likelihood > best.log_likelihood) best = std::move(one);
    }
    return best;
  });
}

}  // namespace rigfit::ident
