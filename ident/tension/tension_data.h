// Modes of a cable with their assignments, and the answer of one (tension_posterior.h).
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "ident/tension/cable_model.h"

namespace rigfit::ident {

/// A mode of the cable, or none (order -1).
struct AssignedMode {
  model::ModePlane plane = model::ModePlane::in;
  int order = -1;  ///< its place in CableFrequencies, from 0
  [[nodiscard]] bool operator==(const AssignedMode&) const = default;
};

struct Assignment {
  std::vector<AssignedMode> modes;  ///< by measured mode
  double score = 0;                 ///< score in the search
  double ln_tension = 0;            ///< there
  double EA = 1;                    ///< factor there
  double x = 1;                     ///< L sqrt(T / EI) there
  double q = 0;                     ///< springs there: 0 pinned, infinity clamped
  double ln_prior = 0;              ///< there: TensionData::ln_assigned
};

/// One value of (EI, k, t): ln T and the uncertain inputs are normal (tension_fit.h).
struct TensionCell {
  double ln_weight = 0;  ///< with the prior and the grid's spacing
  double ln_tension = 0;
  /// Contributions to the variance of ln T.
  double variance_frequency = 0, variance_model = 0;
  std::array<double, kCableInputs.size()> variance_input = {};  ///< likewise, by input
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
  /// State of the heaviest cell.
  [[nodiscard]] CableState state() const { return cells[best].state; }
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
    int rank = 0;  ///< among the modes of its plane by rising frequency, from 1
  };
  /// Modes of the cable by rising frequency, with their probabilities of being seen.
  void list(const CableFrequencies& frequencies, std::vector<Listed>& listed) const;
  /// ln of the probability density factor of pairing measured i with a mode, without the normal;
  /// -infinity where another order is stated.
  [[nodiscard]] double ln_pair(std::size_t i, const Listed& listed) const;
  /// That measured i is no mode of the cable; -infinity where its order is stated.
  [[nodiscard]] double ln_false_of(std::size_t i) const;
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

}  // namespace rigfit::ident
