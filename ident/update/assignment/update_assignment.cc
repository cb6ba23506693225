// Assignments of a problem's measured modes to its modelled ones, and the model's error in them.
#include <fmt/format.h>

#include <cmath>

#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {

UpdateProblem UpdateProblem::with_model_std(double frequency, double damping) const {
  UpdateProblem other = *this;
  other.variant_.model_std = frequency;
  other.variant_.damping_model_std = damping;
  return other;
}

UpdateMatches UpdateProblem::assign_state(int s, const UpdateStateModes& modelled) const {
  const auto& state = states_[static_cast<std::size_t>(s)];
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

UpdateMatches UpdateProblem::assign(const Eigen::VectorXd& q, std::string& failure,
                                    bool scaled) const {
  constexpr double kStep = 0.1, kReach = 0.7;  // ln f: see update_alternatives.h
  UpdateMatches all;
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    const auto& state = states_[static_cast<std::size_t>(s)];
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

}  // namespace rigfit::ident
