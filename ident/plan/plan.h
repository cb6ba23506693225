// Plans which measurements make parameters known to a goal, before anything is measured.
//
// A plan is a set of hammer tests, each in a state of the rig (tension, length), with a hammer,
// with sensors, the first N modes of each plane, hits and the duration of a record. Its information
// on the coordinates q of an update (ln of positive parameters) is
//
//   M = sum_modes (g g' / var(ln f) + h h' / var(ln zeta)) + priors,   g = d ln f / dq, h likewise
//   var(ln f) = 1 / (w^2 sum 1 / var(w)) + model_std^2,   var(ln zeta) = 1 / (a^2 sum 1 / var(a))
//
// with var(w) the Cramer-Rao bound of each hit at each sensor (plan_candidates.h), h only where a
// damping is free, and the inputs that are not fitted as further coordinates: M^-1 is the
// covariance that an update of these modes states.
//
// Steps are chosen one by one: the largest decrease of sum ln(std / goal) over the goals not yet
// reached, per time on the rig (Wynn's greedy exchange; Fedorov, Theory of Optimal Experiments,
// 1972). What no candidate determines is the null space of M without priors.
//
// The prediction is linear and assumes that the scene's values are near the truth, that modes are
// apart, and that every mode is recognised. Masses of further sensors are not added to the rig.
#pragma once

#include "ident/plan/plan_data.h"

namespace rigfit::ident {

/// The scene, then with each other tension (N, of all cables) and length (m, of its only member,
/// whose second node moves), in every combination. Throws std::invalid_argument for tensions
/// without a cable that has one, and for lengths of a scene of several members.
[[nodiscard]] std::vector<UpdateState> plan_states(const model::Scene& scene,
                                                   const std::vector<double>& tensions_N,
                                                   const std::vector<double>& lengths_m);

/// `states` from `plan_states`. A parameter whose value differs between them, such as the tension,
/// becomes one per state, its prior relative. Throws std::invalid_argument for a goal that names no
/// free parameter or is not positive, model::SceneError for an unknown parameter.
[[nodiscard]] PlanResult plan_measurements(const std::vector<UpdateState>& states,
                                           std::vector<FreeParameter> free,
                                           const std::vector<PlanGoal>& goals,
                                           const PlanOptions& options = {});

}  // namespace rigfit::ident
