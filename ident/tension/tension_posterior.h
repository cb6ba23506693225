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
// Unknowns are ln T (flat), EI (given, or x = L sqrt(T / EI) flat in ln x over 2..2000), the end
// springs k = q EI (x + 4) / L (q flat in ln q over 0.03..30: practically pinned to practically
// clamped) and t (0 with probability 0.95, else one of 0.03 to 3
// %; without stated uncertainties only the latter). Length, mass per length, EA and a given EI
// have their uncertainties as priors. A flat prior is a mixture of normal ones (LogRange), so that
// for each of them, and each t, all unknowns are normal about one fit; the posterior is the mixture
// of these. Values at a bound of what can be told count for what they are.
// Candidates of assignments: every pair of a measured and a modelled mode over the ranges of EI and
// k is a hypothesis for T; the best monotone assignment of all others by dynamic programming.
#pragma once

#include <Eigen/Core>
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
  CableShape shape;                 ///< EI and springs there
};

/// One normal density of EI and k, and one t: all unknowns are normal.
struct TensionCell {
  double ln_weight = 0;  ///< with the prior and the grid's spacing
  double ln_tension = 0;
  /// Contributions to the variance of ln T.
  double variance_frequency = 0, variance_model = 0;
  std::array<double, kCableInputs.size()> variance_input = {};  ///< likewise, by input
  std::array<double, kCableInputs.size()> variance_ln = {};     ///< the inputs' own
  CableState state;
  CableShape shape;        ///< the density's centre
  double model_std = 0;    ///< t
  double chi2_stated = 0;  ///< with t = 0 in the weights
};

/// An assignment with one kind of ends.
struct TensionAnswer {
  std::vector<AssignedMode> modes;
  double ln_evidence = -std::numeric_limits<double>::infinity();
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

/// Relative errors t of the model that are summed over; 0 first.
inline constexpr std::array<double, 6> kModelStd = {0, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2};
[[nodiscard]] double ln_prior_of_model_std(std::size_t index, bool stated);

/// The tension that fits an assignment best, with what is known of the cable but not exactly
/// (length, mass per length, EA ..., EI and springs about a centre), each ln normal about its
/// value.
///
///   min  sum_i (ln f_i - ln f_i(T, z))^2 / (s_i^2 + t^2) + sum_j z_j^2
///
/// over ln T and z, z_j the departure of input j from its value in standard uncertainties. With J
/// the derivatives of ln f and H = J' W J + diag(0, 1, ...), the cell is normal about the minimum
/// with covariance H^-1. A taut cable says nothing about z; one that sags does, and an EA off by
/// two standard uncertainties must not look like another tension.
class TensionFit {
 public:
  TensionFit(const CableModel& model, const TensionData& data,
             const std::vector<AssignedMode>& modes, bool springs);

  [[nodiscard]] int pairs() const { return pairs_; }

  /// From a start, about a centre of EI and springs. False where it does not converge.
  [[nodiscard]] bool fit(const CableState& start, const CableShape& shape);
  /// Where the last fit ended, factors included.
  [[nodiscard]] CableState state() const;

  /// One cell a value of t about the last fit.
  void add_cells(double ln_prior, std::vector<TensionCell>& cells);

 private:
  /// Weights of one value of t.
  struct Normal {
    Eigen::MatrixXd H;
    Eigen::VectorXd gradient;
    double squares = 0, ln_density = 0;
  };

  [[nodiscard]] CableState at(const Eigen::VectorXd& unknowns) const;
  void residuals(const Eigen::VectorXd& unknowns, Eigen::VectorXd& values);
  void slopes();
  [[nodiscard]] Normal normal(double model_variance) const;
  /// Newton steps with the weights of t; false where they do not end.
  [[nodiscard]] bool converge(double model_variance, int steps);

  const CableModel& model_;
  const TensionData& data_;
  const std::vector<AssignedMode>& modes_;
  std::vector<CableInput> inputs_;
  int count_ = 0, pairs_ = 0;
  CableShape shape_;
  Eigen::VectorXd unknowns_, residual_, variance_;
  Eigen::MatrixXd slope_;     // d ln f / d unknowns
  Eigen::VectorXd slope_at_;  // the unknowns there
  CableRoots roots_;          // roots at the last state
  CableState slope_state_;
};

/// Assignments worth a look, best first.
[[nodiscard]] std::vector<Assignment> search_assignments(const CableModel& model,
                                                         const TensionData& data);

/// Posterior of one assignment; no cells where it leaves no pair, few where it is far below the
/// evidence of the best one.
[[nodiscard]] TensionAnswer tension_answer(const CableModel& model, const TensionData& data,
                                           CableEnds ends, const Assignment& assignment,
                                           double ln_evidence_of_best);

/// Whether EI is one number without an uncertainty.
[[nodiscard]] bool EI_is_exact(const CableDescription& cable);

/// One kind of ends: its model as corrected, its answers, heaviest first.
struct EndsPosterior {
  CableEnds ends = CableEnds::pinned;
  CableModel model;
  std::vector<TensionAnswer> answers;
  double ln_evidence = -std::numeric_limits<double>::infinity();
  bool corrected = true;  ///< false: needed and not to be had

  [[nodiscard]] CableState state() const { return answers.front().state(); }
};

/// Mean and variances of T over the cells of one or several kinds of ends, by the law of total
/// variance: between ends, assignments, springs, rigidities; within: frequencies and model.
struct TensionSummary {
  signal::Estimate tension, EI, spring;
  double low = 0, high = 0;
  std::vector<TensionBudgetRow> budget;
};

/// Value, std and budget are of what lies in the 95 % interval or within half its width beside it:
/// an improbable other answer far off would otherwise make the std larger than the interval.
[[nodiscard]] TensionSummary summarise_tension(const std::vector<const EndsPosterior*>& all);

}  // namespace rigfit::ident
