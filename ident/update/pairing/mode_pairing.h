// Pairs modelled and measured modes by their properties, never by row number.
//
// An optimal assignment (Hungarian method) of the least total cost, in which any mode may stay
// unpaired at a price. The cost of a pair is
//
//   (ln(f_model / f_measured) / frequency_scale)^2 + (1 - MAC) / mac_scale + plane_price [planes
//   differ]
//
// with the shape's term where both shapes are known and the plane's where both planes are. Modes
// from tests in different planes (in, out) are assigned test by test, because each test can see
// every mode: a mode of the other plane that shows up in a test is cross-plane leakage, and the
// same modelled mode may then be paired once in each.
// Sources: Kuhn 1955 (assignment), Allemang 2003 (MAC), Ewins, Modal Testing, 6.2.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "model/linear/modal_analysis.h"

namespace rigfit::ident {

struct PairingMode {
  double frequency_hz = 0;
  std::optional<model::ModePlane> plane = std::nullopt;  ///< measured: the plane of the test
  Eigen::VectorXcd shape = {};  ///< at the same points on both sides; empty: not known
  /// How much the test could see of a modelled mode, 0..1 (driving and response point off its
  /// nodes). An invisible mode costs nothing when it stays unpaired.
  double visibility = 1;
};

struct PairingOptions {
  double frequency_scale = 0.1;  ///< relative deviation that costs 1
  double mac_scale = 0.5;        ///< loss of MAC that costs 1
  double plane_price = 1.5;      ///< price of pairing across planes
  /// Prices of leaving a mode unpaired. A pair is made when it costs less than both together: 20 %
  /// in frequency with these.
  double unpaired_measured = 2;
  double unpaired_model = 2;
  /// Above 1: also tries a factor common to all modelled frequencies, between the inverse and this
  /// (a model with a wrong tension errs in all modes alike). It costs like one more deviation of
  /// that size over `common_factor_scale`.
  double common_factor_range = 1;
  double common_factor_scale = 0.5;
};

struct ModePair {
  int measured = 0, model = 0;  ///< indices of the input
  double relative_error = 0;    ///< f_model / f_measured - 1
  double mac = std::numeric_limits<double>::quiet_NaN();
  double cost = 0;
  bool cross_plane = false;  ///< leakage: the modelled mode lies in another plane than the test
};

struct UnpairedMode {
  int index = 0;
  /// A modelled mode between the lowest and the highest measured frequency of a test in its plane:
  /// the test missed it. Outside, the test did not look.
  bool missing = false;
  std::string reason;  ///< for a person
};

struct ModePairing {
  std::vector<ModePair> pairs;  ///< by measured index
  std::vector<UnpairedMode> unpaired_measured, unpaired_model;
  double cost = 0;           ///< total cost of the assignment
  double common_factor = 1;  ///< common factor used for the pairs
};

/// Throws std::invalid_argument for frequencies that are not positive and finite.
[[nodiscard]] ModePairing pair_modes(const std::vector<PairingMode>& measured,
                                     const std::vector<PairingMode>& modelled,
                                     const PairingOptions& options = {});

/// |a^H b|^2 / (a^H a b^H b), 0..1; NaN when either is empty, zero, of another length, or too short
/// (one point) to say anything.
[[nodiscard]] double shape_correlation(const Eigen::Ref<const Eigen::VectorXcd>& a,
                                       const Eigen::Ref<const Eigen::VectorXcd>& b);

/// Column of each row in an assignment of least total cost; rows x columns with rows <= columns.
[[nodiscard]] std::vector<int> least_cost_assignment(const Eigen::Ref<const Eigen::MatrixXd>& cost);

/// Root mean square of the pairs' relative errors, leakage left out; NaN without pairs.
[[nodiscard]] double rms_relative_error(const ModePairing& pairing);

}  // namespace rigfit::ident
