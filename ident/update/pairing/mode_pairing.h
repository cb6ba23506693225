// Pairs modelled and measured modes by their properties, never by row number, for lists.
//
// An optimal assignment (Hungarian method) of the least total cost, in which any mode may stay
// unpaired at a price. The cost of a pair is
//
//   (ln(f_model / f_measured) / 0.1)^2 + (1 - MAC) / 0.5 + 1.5 [planes differ]
//
// with the shape's term where both shapes are known and the plane's where both planes are; a pair
// that costs more than 4 is none. Modes from tests in different planes (in, out) are assigned test
// by test, because each test can see every mode: a mode of the other plane that shows up in a test
// is cross-plane leakage, and the same modelled mode may then be paired once in each.
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
  double visibility = 1;        ///< how well a modelled mode is seen (mode_assignment.h)
};

struct ModePair {
  int measured = 0, model = 0;  ///< indices of the input
  double mac = std::numeric_limits<double>::quiet_NaN();
  bool cross_plane = false;  ///< leakage: the modelled mode lies in another plane than the test
};

struct UnpairedMode {
  int index = 0;
  std::string reason;  ///< for a person
};

struct ModePairing {
  std::vector<ModePair> pairs;         ///< by measured index
  std::vector<UnpairedMode> unpaired;  ///< measured
  /// Modelled, between the lowest and the highest measured frequency of a test in their plane;
  /// outside, the test did not look.
  std::vector<UnpairedMode> missed;
};

/// Throws std::invalid_argument for frequencies that are not positive and finite.
[[nodiscard]] ModePairing pair_modes(const std::vector<PairingMode>& measured,
                                     const std::vector<PairingMode>& modelled);

/// |a^H b|^2 / (a^H a b^H b), 0..1; NaN when either is empty, zero, of another length, or too short
/// (one point) to say anything.
[[nodiscard]] double shape_correlation(const Eigen::Ref<const Eigen::VectorXcd>& a,
                                       const Eigen::Ref<const Eigen::VectorXcd>& b);

/// Column of each row in an assignment of least total cost; rows x columns with rows <= columns.
[[nodiscard]] std::vector<int> least_cost_assignment(const Eigen::Ref<const Eigen::MatrixXd>& cost);

/// Both are known to be one of in and out, and not the same; a mode that is mixed, axial or
/// torsional may show in either test.
[[nodiscard]] bool planes_differ(const std::optional<model::ModePlane>& measured,
                                 const std::optional<model::ModePlane>& modelled);

/// Indices of the measured modes of each plane that is named among them: a test each.
[[nodiscard]] std::vector<std::vector<int>> tests_of(const std::vector<PairingMode>& measured);

}  // namespace rigfit::ident
