// Uncertainty of the parameters of a least-squares fit: covariance, and the names of parameters
// that the data cannot separate.
//
// With J the Jacobian of residuals already divided by their standard deviations and S a diagonal
// matrix of the parameters' scales, J S = U diag(s) V'. A direction v_i of relative change is known
// to 1 / s_i, so var(p_j) = S_j^2 sum_i (V_ji / s_i)^2. A parameter whose relative standard
// uncertainty exceeds `max_relative_std` is not determined and gets none; each direction
// responsible is reported. Source: Golub and Van Loan, Matrix Computations, 5.5; Bard, Nonlinear
// Parameter Estimation, 7.
#pragma once

#include "ident/statistics/numbers.h"
#include "signal/estimation/groups.h"

namespace rigfit::ident {

/// An estimate with its 95 % interval.
struct BoundedEstimate : Estimate, signal::Interval {
  bool one_sided = false;  ///< only `low` is known of the quantity
};

/// Relative standard uncertainty above which a parameter counts as not determined: at most its
/// order of magnitude is known.
inline constexpr double kMaxRelativeStd = 1;

/// A direction in parameter space that the data do not determine.
struct OpenDirection {
  std::vector<std::string> parameters;  ///< those that take part, the strongest first
  std::string message;                  ///< for a person

  static constexpr auto fields() {
    using T = OpenDirection;
    return std::tuple{describe::field("parameters", &T::parameters),
                      describe::field("message", &T::message)};
  }
};

struct Identifiability {
  std::vector<bool> identifiable;
  VectorXd std;         ///< NaN where not identifiable
  MatrixXd covariance;  ///< rows and columns of unidentifiable parameters are NaN
  std::vector<OpenDirection> open;
  MatrixXd directions;       ///< columns of S V
  VectorXd singular_values;  ///< of J S, falling; 0 where they are that to its accuracy

  /// Standard uncertainty of a quantity with this gradient by the parameters. It may be determined
  /// even where the parameters are not; NaN when it is not.
  [[nodiscard]] double std_of(const Ref<const VectorXd>& gradient) const;
};

/// `jacobian` residuals x parameters, whitened; `scales` (> 0): parameters' change that counts
/// as 1. Throws std::invalid_argument when sizes differ. A Jacobian with values that are not finite
/// determines no parameter.
[[nodiscard]] Identifiability identifiability(const Ref<const MatrixXd>& jacobian,
                                              const Ref<const VectorXd>& scales,
                                              const std::vector<std::string>& names,
                                              double max_relative_std = kMaxRelativeStd);

/// A probability with two digits: "0.012", "below 1e-6", where it depends on the assumed
/// distribution more than on the data; "-" for NaN, where nothing is left over to judge by.
[[nodiscard]] std::string probability_text(double p);

using signal::coverage_factor;

}  // namespace rigfit::ident
