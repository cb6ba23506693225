// What is done about the number of segments in an update.
//
// Members with given segments are that model: its parameters are fitted. Where all members leave
// them to the program ("auto") the scene stands for the rig itself. Small as the error of 30
// segments is, it is a large part of what a weakly acting parameter does (bending in a taut cable:
// 3.6 % of EI). The model's own frequencies for vanishing segments
// (model/linear/segment_extrapolation.h), found at the parameters and held, give the error of the
// chain, which is taken off wherever that chain is asked, until it no longer moves the parameters.
// FRFs get 2, 4 or 8 times the segments.

#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {
namespace {

// Frequencies for vanishing segments: relative accuracy as a share of what they are known to.
constexpr double kShareOfStd = 0.1;
}  // namespace

bool UpdateProblem::is_resolved(int state) const {
  return variant_.segment_errors &&
         !(*variant_.segment_errors)[static_cast<std::size_t>(state)].empty();
}

UpdateProblem UpdateProblem::with_resolved_modes(const VectorXd& q, bool given) const {
  UpdateProblem other = with(&UpdateVariant::segment_errors, nullptr);
  auto errors = std::make_shared<std::vector<SegmentErrors>>(states_.size());
  for (std::size_t s = 0; s < states_.size(); ++s) {
    const auto& state = states_[s];
    const int index = static_cast<int>(s);
    const model::Scene scene = scene_at(index, q);
    const bool open =
        given || std::ranges::all_of(
                     scene.members, [](int n) { return n == 0; }, &model::Member::segments);
    if (state.measured.empty() || state.modes_lead_only || !open) continue;
    double accuracy = scene.accuracy;
    for (std::size_t m = 0; m < state.measured.size(); ++m) {
      accuracy = std::min(accuracy, kShareOfStd * relative_std(index, static_cast<int>(m)));
    }
    model::ModesOptions asked;
    asked.count = mode_count(index);
    asked.shapes = asked.error_estimate = false;
    asked.accuracy = std::max(accuracy, kComparedAccuracy);
    const auto here = other.modes(index, q, false);
    const auto limit = model::analyse_modes(scene, asked);
    if (!here.failure.empty() || !limit.extrapolated) continue;
    std::map<model::ModePlane, int> seen;
    for (const auto& natural : limit.modes) {
      const int order = seen[natural.plane]++;
      const auto* mode = here.find(natural.plane, order);
      if (mode == nullptr || !known(natural.frequency_hz)) continue;
      (*errors)[s][{natural.plane, order + 1}] =
          std::log(mode->frequency_hz / natural.frequency_hz);
    }
  }
  if (std::ranges::any_of(*errors, [](const auto& of_state) { return !of_state.empty(); })) {
    other.variant_.segment_errors = std::move(errors);
  }
  return other;
}

bool UpdateProblem::resolved_as(const UpdateProblem& finer, const std::vector<UpdateMatch>& matches,
                                const VectorXd& q) const {
  constexpr double kSmall = 0.01;
  VectorXd here, fine;
  return !residuals(q, matches, here, nullptr) || !finer.residuals(q, matches, fine, nullptr) ||
         (here - fine).squaredNorm() < kSmall;
}

UpdateProblem UpdateProblem::with_resolving_segments(const std::vector<UpdateMatch>& matches,
                                                     const VectorXd& q) const {
  constexpr double kMostTimes = 8;
  UpdateProblem settled = *this;
  for (const auto& state : states_) {
    for (const auto& member : state.scene.members) {
      if (member.segments != 0) return settled;
    }
  }
  for (double factor = 2; factor <= kMostTimes; factor *= 2) {
    UpdateProblem finer = with(&UpdateVariant::segment_factor, factor);
    if (settled.resolved_as(finer, matches, q)) break;
    settled = std::move(finer);
  }
  return settled;
}

}  // namespace rigfit::ident
