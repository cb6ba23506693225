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

#include "ident/bending/bending_analysis.h"
#include "ident/campaign/single_tests/test_recording.h"
#include "ident/stiffness/stiffness_curve.h"

namespace rigfit::ident {

/// Cross-section of a beam bent without tension, given in one of three ways or not at all.
struct BeamSection {
  std::vector<double> rectangle_m;  ///< width, height; empty: not given
  double diameter_m = 0;            ///< round and solid; 0: not given
  double second_moment_m4 = 0;      ///< 0: not given
  /// Relative standard uncertainty of the second moment: three times that of a height, four times
  /// that of a diameter.
  double relative_std = 0;

  /// Second moment of area about the axis of bending, m^4: w h^3 / 12 (h along the load) or
  /// pi d^4 / 64; NaN where no section is given.
  [[nodiscard]] Estimate second_moment() const;
};

/// One file: a load-deflection record or table, or (`record` empty) EI values.
struct BendingSource {
  std::string name;  ///< for messages and results
  BendingRecord record;
  std::vector<StiffnessPoint> values;
  Origin origin = Origin::measured;
};

struct BendingCampaign {
  std::vector<BendingSource> sources;
  BendingTestOptions test;  ///< span and calibrations with uncertainties; for records only
  std::optional<StrandGeometry> strand;
  BeamSection section = {};         ///< without tension it gives Young's modulus in bending, EI / I
  double assumed_relative_std = 0;  ///< for EI values without an uncertainty; 0: unknown
};

/// One tension of one source, as it is printed and written.
struct BendingPoint {
  std::string file;  ///< name of the source
  Origin origin = Origin::measured;
  std::optional<std::size_t> row = {};  ///< of EI values, from 1; empty: from a record
  BendingRecord record = {};            ///< the rows at this tension; empty: EI values
  std::optional<BendingTestResult> analysis = {};
  StiffnessPoint point = {};                 ///< NaN where refused
  Estimate slope_N_m = {}, modulus_Pa = {};  ///< NaN: not known, or with tension

  [[nodiscard]] bool refused() const { return analysis && analysis->refused; }
  /// Whether laws and curve use this EI.
  [[nodiscard]] bool usable() const { return !refused() && point.EI_Nm2 > 0; }
  [[nodiscard]] bool beam() const { return analysis && analysis->ends != BeamEnds::tensioned; }

  static constexpr auto fields() {
    using namespace describe;
    using T = BendingPoint;
    using Point = StiffnessPoint;
    constexpr auto EI = [](const T& p) -> Bounded {
      return {p.point.EI_Nm2, p.point.std, p.point.low, p.point.high};
    };
    return std::tuple{
        field("tension_N", within(&T::point, &Point::tension_N), "N", "",
              "mean over the samples used; 0 without tension"),
        field("", where([](const T& p) { return !p.beam(); }, within(&T::point, &Point::tension_N)),
              "N", "tension", "", 5),
        field("stiffness_N_m", &T::slope_N_m, "N/m", "slope", "load over deflection"),
        field("EI_Nm2", EI, "N m2", "EI", "flexural rigidity"),
        field(
            "",
            [](const T& p) {
              return Ends{p.point.low, p.point.high, p.point.std};
            },
            "", "95 % interval", ""),
        field("modulus_Pa", &T::modulus_Pa, "Pa", "modulus", "EI over the second moment"),
        field("refused", &T::refused, "", "", "see the warnings"),
        field(
            "", [](const T& p) { return std::string(p.refused() ? "refused" : ""); }, "", "remark",
            ""),
        field(
            "ends",
            [](const T& p) { return std::string(p.beam() ? name_of(p.analysis->ends) : ""); }, "",
            "", "clamped, pinned or cantilever, without tension"),
        field("row", &T::row, "", "", "of a table of EI, from 1"),
        field("shared_relative_std", within(&T::point, &Point::shared_relative_std), "", "",
              "common to all tests"),
        field("tension_spread_N", within(&T::point, &Point::tension_std_N), "N", "",
              "std of the tension within a test"),
        field(
            "hysteresis_N", [](const T& p) { return p.analysis ? p.analysis->hysteresis_N : 0; },
            "N", "", "half between loading and unloading"),
        field("file", &T::file, "", "from", "")};
  }
};

/// Specimens of one kind, bent without tension, with plain means, as each is one draw of the kind.
struct BeamSpecimens {
  std::size_t count = 0;
  double EI_Nm2 = 0, modulus_Pa = 0;  ///< means; modulus NaN without a section
  double relative_scatter = 0;  ///< standard deviation between specimens, relative to the mean

  static constexpr auto fields() {
    using namespace describe;
    using T = BeamSpecimens;
    return std::tuple{
        field("count", &T::count, "", "specimens", "that gave an EI"),
        field("EI_Nm2", &T::EI_Nm2, "N m2", "mean EI", "plain mean", 3),
        field("modulus_Pa", where([](const T& s) { return s.modulus_Pa > 0; }, &T::modulus_Pa),
              "Pa", "mean modulus", "plain mean", 3),
        field("relative_scatter", &T::relative_scatter, "%", "scatter between them",
              "standard deviation", 2)};
  }
};

struct BendingCampaignResult {
  std::vector<BendingPoint> points;  ///< by rising tension
  StiffnessCurve curve;              ///< law through the usable points; empty: none
  std::optional<StiffnessBounds> bounds;
  std::optional<BeamSpecimens> specimens;  ///< if two or more gave an EI without tension
  double assumed_relative_std = 0;         ///< as given
  /// Those of the points, then on all together: "no_EI" (refused), "taken_as_exact",
  /// "outside_bounds", "length_suspected", "large_deflection".
  std::vector<Finding> findings;

  [[nodiscard]] bool has_laws() const {
    return !curve.laws().laws.empty() || !curve.laws().sentence.empty();
  }
  static constexpr auto fields() {
    using namespace describe;
    using T = BendingCampaignResult;
    using Laws = StiffnessLaws;
    return std::tuple{
        field("tests", &T::points, "", "tests", "by rising tension"),
        field("specimens", &T::specimens, "", "specimens", "without tension, two or more"),
        field("bounds", &T::bounds, "", "bounds", "by the strand's geometry"),
        field("laws", within(&T::curve, within(&StiffnessCurve::laws, &Laws::laws)), "", "laws",
              "best first"),
        field("law_choice", where(&T::has_laws, within(&T::curve, &StiffnessCurve::laws))),
        field("curve", where([](const T& r) { return !r.curve.empty(); }, &T::curve), "", "curve",
              "as a model takes it"),
        field("assumed_relative_std", positive(&T::assumed_relative_std))};
  }
};

/// Throws std::invalid_argument like analyse_bending_test, stiffness_bounds and fit_stiffness_laws.
[[nodiscard]] BendingCampaignResult analyse_bending_campaign(const BendingCampaign& campaign);

}  // namespace rigfit::ident
