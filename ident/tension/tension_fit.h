// The tension that fits an assignment best, with what is known of the cable but not exactly:
// length, mass per length, EA and EI, each ln normal about its value.
//
//   min  sum_i (ln f_i - ln f_i(T, z))^2 / (s_i^2 + t^2) + sum_j z_j^2
//
// over ln T and z, z_j the departure of input j from its value in standard uncertainties. With J
// the derivatives of ln f and H = J' W J + diag(0, 1, ...), the cell of (EI, k, t) is normal about
// the minimum with covariance H^-1. A taut cable says nothing about z; one that sags does, and an
// EA off by two standard uncertainties must not look like another tension.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "ident/tension/tension_data.h"

namespace rigfit::ident {

/// Relative errors t of the model that are summed over; 0 first.
inline constexpr std::array<double, 6> kModelStd = {0, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2};
[[nodiscard]] double ln_prior_of_model_std(std::size_t index, bool stated);

class TensionFit {
 public:
  using StateAt = std::function<CableState(double ln_tension)>;

  TensionFit(const CableModel& model, const TensionData& data,
             const std::vector<AssignedMode>& modes);

  [[nodiscard]] int pairs() const { return pairs_; }

  /// From `start` (T and the factors of the inputs); `state_at` gives EI and springs at a tension.
  /// False where it does not converge.
  [[nodiscard]] bool fit(const CableState& start, const StateAt& state_at);
  /// Where the last fit ended, factors included.
  [[nodiscard]] CableState state() const;

  /// One cell a value of t about the last fit.
  void add_cells(double ln_prior, const TensionCell& at, std::vector<TensionCell>& cells);

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
  StateAt state_at_;
  Eigen::VectorXd unknowns_, residual_, variance_;
  Eigen::MatrixXd slope_;     // d ln f / d unknowns
  Eigen::VectorXd slope_at_;  // the unknowns there
  CableRoots roots_;          // roots at the last state
  CableState slope_state_;
};

}  // namespace rigfit::ident
