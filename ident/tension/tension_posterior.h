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

#include <array>
#include <limits>
#include <vector>

#include "ident/tension/cable_model.h"

namespace rigfit::ident {

/// A mode of the cable, or none (order -1).
struct AssignedMode {
  model::ModePlane plane = model::ModePlane::in;
  int order = -1;  ///< in its plane, from 0
  [[nodiscard]] bool operator==(const AssignedMode&) const = default;
};

struct Assignment {
  std::vector<AssignedMode> modes;  ///< by measured mode
  double score = 0;                 ///< of the search
  double ln_tension = 0;            ///< there
  double EA = 1;                    ///< factor there
  double ln_prior = 0;              ///< there: TensionData::ln_assigned
};

/// One value of (EI, k, t): ln T and the uncertain inputs are normal (tension_fit.h).
struct TensionCell {
  double ln_weight = 0;  ///< with the prior and the grid's spacing
  double ln_tension = 0;
  double variance_frequency = 0, variance_model = 0;            ///< of ln T
  std::array<double, kCableInputs.size()> variance_input = {};  ///< of ln T, by input
  double variance_ln_EI = 0;                                    ///< within the cell
  CableState state;
  int spring = 0;          ///< index of the grid's value
  int rigidity = 0;        ///< index of the grid's value among those of this spring
  double model_std = 0;    ///< t
  double chi2_stated = 0;  ///< with t = 0 in the weights
};

/// An assignment with one kind of ends.
struct TensionAnswer {
  std::vector<AssignedMode> modes;
  double ln_evidence = -std::numeric_limits<double>::infinity();
  double ln_prior = 0;             ///< TensionData::ln_assigned at the heaviest cell
  std::vector<TensionCell> cells;  ///< those within exp(-18) of the heaviest
  std::size_t best = 0;            ///< the heaviest
  [[nodiscard]] CableState state() const { return cells[best].state; }  ///< of the heaviest
};

/// What the measured frequencies are, sorted, with the options: shared by search and posterior.
class TensionData {
 public:
  /// By rising frequency.
  TensionData(std::vector<MeasuredMode> modes, const TensionOptions& options);

  struct Listed {
    double ln_hz = 0;
    AssignedMode mode;
    double ln_seen = 0, ln_unseen = 0;
  };
  /// Modes of the cable by rising frequency, with their probabilities of being seen.
  void list(const CableFrequencies& frequencies, std::vector<Listed>& listed) const;
  /// ln of the probability density factor of pairing measured i with a mode, without the normal.
  [[nodiscard]] double ln_pair(std::size_t i, const Listed& listed) const;
  /// ln of the part of the likelihood that an assignment has whatever the frequencies' misfit.
  [[nodiscard]] double ln_assigned(const std::vector<AssignedMode>& assigned,
                                   const std::vector<Listed>& listed) const;

  std::vector<MeasuredMode> modes;
  std::vector<double> ln_hz, variance;  ///< 0 where not stated
  bool stated = true;
  double ln_false = 0;
  double highest_hz = 0, lowest_hz = 0;

 private:
  bool in_ = false, out_ = false, any_ = false;
  TensionOptions options_;
};

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
