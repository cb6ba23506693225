// Which modes of a cable the measured ones are, and what tension follows: a numerical posterior.
//
// An assignment gives every measured frequency a mode (plane and order) of the cable, or none. With
// P_j the probability that the test sees mode j, s_i the standard uncertainty of ln f_i and t a
// relative error of the model, an assignment has the likelihood
//
//   pairs      (1 - false) P_j N(ln f_i - ln f_j(T, EI, k); s_i^2 + t^2)
//   unpaired   false / (width of the band in ln f) for each measured frequency
//   unseen     1 - P_j for each mode up to the highest paired frequency: false ones (hum) may lie
//              beyond the band that the cable was excited in
//
// Unknowns are ln T (flat), EI (given, given with an uncertainty, or x = L sqrt(T / EI) flat in
// ln x over 2..2000), the end springs k = q EI (x + 4) / L (q flat in ln q over 0.03..30:
// practically pinned to practically clamped) and t (0 with probability 0.95, else one of 0.03 to 3
// %; without stated uncertainties only the latter). Length, mass per length, EA and an EI known to
// 30 % or better have their uncertainties as priors. ln T and these are normal given the others;
// the others are summed over grids that are refined until they resolve the posterior. Nothing is
// linearised in EI or k, so that values at a bound of what can be told count for what they are.
// Candidates of assignments: every pair of a measured and a modelled mode over the ranges of EI and
// k is a hypothesis for T; the best monotone assignment of all others by dynamic programming.
#pragma once

#include <vector>

#include "ident/tension/cable_model.h"
#include "ident/tension/tension_data.h"

namespace rigfit::ident {

/// Assignments worth a look, best first.
[[nodiscard]] std::vector<Assignment> search_assignments(const CableModel& model,
                                                         const TensionData& data);

/// Posterior of one assignment; no cells where it leaves no pair. Coarse where it is far below the
/// evidence of the best one.
[[nodiscard]] TensionAnswer tension_answer(const CableModel& model, const TensionData& data,
                                           CableEnds ends, const Assignment& assignment,
                                           double ln_evidence_of_best);

/// The state that fits an assignment best at the x (or EI where it is given) and k of a state.
[[nodiscard]] CableState refitted(const CableModel& model, const TensionData& data,
                                  const std::vector<AssignedMode>& modes, const CableState& state);

/// Whether EI is one number without an uncertainty.
[[nodiscard]] bool EI_is_exact(const CableDescription& cable);
/// The number in use where it is exact, or given: a string is a beam of x = 1e5.
[[nodiscard]] double given_EI(const CableDescription& cable, double tension_N);

}  // namespace rigfit::ident
