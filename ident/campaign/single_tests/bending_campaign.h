// Evaluates the bending tests of a campaign: from load-deflection records at one or more tensions,
// or from given EI values, to EI at each tension, laws EI(T) and the curve for models.
//
//   records -> analyse_bending_test (each tension of a table by itself) -> points
//   EI values ------------------------------------------------------------> points
//   points -> StiffnessCurve (shared uncertainty does not enter the weights of its laws)
//
// Tests share the uncertainties of span and calibrations (load, deflection, tension), which the
// sensitivities of the bending equation convert to EI. Tests without tension have no EI(T): their
// curve is empty, and EI and modulus come with the scatter between specimens.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ident/bending/bending_analysis.h"
#include "ident/stiffness/stiffness_curve.h"
#include "ident/stiffness/strand.h"

namespace rigfit::ident {

/// One file: a load-deflection record or table, or (`record` empty) EI values.
struct BendingSource {
  std::string name;  ///< for messages and results
  BendingRecord record;
  std::vector<StiffnessPoint> values;
};

struct BendingCampaign {
  std::vector<BendingSource> sources;
  BendingTestOptions test;  ///< span and calibrations with uncertainties; for records only
  std::optional<StrandGeometry> strand;
  /// Second moment of the cross-section about the axis of bending, m^4; NaN: not known. Without
  /// tension it gives Young's modulus in bending, EI / I.
  signal::Estimate second_moment_m4;
  double assumed_relative_std = 0;  ///< for EI values without an uncertainty; 0: unknown
};

/// One tension of one source.
struct BendingPoint {
  std::size_t source = 0;
  std::size_t row = 0;   ///< row of EI values, from 1; 0: from a record
  BendingRecord record;  ///< the rows at this tension; empty: EI values
  std::optional<BendingTestResult> analysis;
  StiffnessPoint point;  ///< NaN where refused

  [[nodiscard]] bool refused() const { return analysis && analysis->refused; }
  /// Whether laws and curve use this EI.
  [[nodiscard]] bool usable() const { return !refused() && point.EI_Nm2 > 0; }
};

/// Specimens of one kind, bent without tension, with plain means, as each is one draw of the kind.
struct BeamSpecimens {
  std::size_t count = 0;
  double EI_Nm2 = 0, modulus_Pa = 0;  ///< means; modulus NaN without a section
  double relative_scatter = 0;  ///< standard deviation between specimens, relative to the mean
};

struct BendingCampaignResult {
  std::vector<BendingPoint> points;  ///< by rising tension
  StiffnessCurve curve;              ///< law through the usable points; empty: none
  std::optional<StiffnessBounds> bounds;
  std::optional<BeamSpecimens> specimens;  ///< if two or more gave an EI without tension
  /// Findings on all points together: "taken_as_exact", "tension_within_test", "outside_bounds",
  /// "length_suspected", "large_deflection".
  std::vector<BendingFinding> findings;
};

/// A table of at most this many rows is split by tension; a longer one is a record of one test.
inline constexpr Eigen::Index kLongestBendingTable = 400;

/// Throws std::invalid_argument like analyse_bending_test, stiffness_bounds and fit_stiffness_laws.
[[nodiscard]] BendingCampaignResult analyse_bending_campaign(const BendingCampaign& campaign);

/// Young's modulus in bending of a test without tension, Pa; NaN without a second moment.
[[nodiscard]] signal::Estimate bending_modulus(const BendingCampaign& campaign,
                                               const BendingPoint& point);

/// Uncertainty of a test's EI that it shares with others of the same span and instruments, relative
/// to EI: root of the sum of squares.
[[nodiscard]] double shared_relative_std(const BendingTestResult& test,
                                         const BendingTestOptions& options);

}  // namespace rigfit::ident
