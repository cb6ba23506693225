// Laws for a strand's flexural rigidity over its tension, EI(T), fitted to bending tests.
//
//   linear       EI = a + b T
//   square root  EI = a + b sqrt(T)
//   power        EI = a (T / T0)^b,  T0 the geometric mean of the tested tensions
//   saturating   EI = EImin + (EImax - EImin) T / (T + Th): free slip at rest, no slip at T >> Th;
//                EImin and EImax are fixed where the strand's geometry gives them, else fitted
//
// The fit is weighted least squares (Ceres, analytic derivatives) with the points' own standard
// deviations. The tension within a test at which EI holds is one more parameter, common to all
// points, with a prior (below). Points without intervals get equal relative weights, and
// their scatter gives the variance. Ranking: AICc (Burnham and Anderson, Model Selection and
// Multimodel Inference, 2002, 2.4), chi^2 + 2 k + 2 k (k + 1) / (n - k - 1) with known weights, n
// ln(RSS / n) + ... with one parameter more without.
//
// The tension that a bending test's EI belongs to: a cable that is loaded across pulls harder, so
// the tension changes within the test. The friction between its wires may be that of the tension at
// rest, or follow the tension of the moment, so that EI belongs to some tension between the lowest
// and the highest of the test. About the mean tension Tm, where a test states its EI, that is a
// rectangular distribution (GUM 4.3.7):
//   u_T^2 = (T_low + T_high - 2 Tm)^2 / 4 + (T_high - T_low)^2 / 12
// Which of the two it is holds for all tests of a cable: one standard normal parameter moves the EI
// of all points together by d EI / dT u_T, with dEI/dT by the power law through the points, one for
// all laws, so that their chi-squares compare. Repeats do not average it.
#pragma once

#include "ident/statistics/numbers.h"

namespace rigfit::ident {

/// Bounds of a strand: EImin = sum_i E pi d_i^4 / 64 (all elements slip), EImax = E pi d_c^4 / 64
/// (none does). Source: Jalali and Rideout 2021, eqs. (20), (21).
struct StrandGeometry {
  double youngs_modulus_Pa = 0;
  int elements = 0;  ///< round wires
  double element_diameter_m = 0;
  double strand_diameter_m = 0;
};

struct StiffnessBounds {
  double EI_min_Nm2 = 0;
  double EI_max_Nm2 = 0;

  static constexpr auto fields() {
    using T = StiffnessBounds;
    return std::tuple{
        field("EI_min_Nm2", &T::EI_min_Nm2, "N m2", "strand, EI at least", "wires slip freely", 4),
        field("EI_max_Nm2", &T::EI_max_Nm2, "N m2", "strand, EI at most", "wires do not slip", 4)};
  }
};

/// Throws std::invalid_argument for values that are not positive and finite.
[[nodiscard]] StiffnessBounds stiffness_bounds(const StrandGeometry& geometry);

enum class LawKind { linear, square_root, power, saturating };
[[nodiscard]] const char* name_of(LawKind kind);

/// One bending test's result. Without an interval: `std`, `low` and `high` NaN.
struct StiffnessPoint {
  double tension_N = 0;
  double EI_Nm2 = 0;
  double std = kNaN;
  double low = kNaN;
  double high = kNaN;
  /// Uncertainty shared with the other points (span, calibration), relative to EI. It does not
  /// enter the weight but every band.
  double shared_relative_std = 0;
  /// u_T: std of the tension at which EI holds, from its spread within the test.
  double tension_std_N = 0;
};

/// Standard deviation of a point without what it shares with others; NaN: not known.
[[nodiscard]] double own_std(const StiffnessPoint& point);

struct StiffnessLawOptions {
  std::optional<StiffnessBounds> bounds =
      std::nullopt;  ///< bounds of the strand; they fix the saturating law's ends
  /// Used for points without an interval instead of their scatter; 0: the scatter is used.
  double assumed_relative_std = 0;
};

struct LawParameter {
  std::string name;
  double value = 0;
  double std = 0;  ///< NaN when the points do not determine it
  std::string unit;
  bool fixed = false;  ///< by the strand's geometry

  static constexpr auto fields() {
    using T = LawParameter;
    return std::tuple{field("name", &T::name, "", "parameter", "of the formula"),
                      field("value", &T::value, "", "value", ""),
                      field("std", &T::std, "", "std", "null where the points do not determine it"),
                      field("unit", &T::unit, "", "unit", "of the value"),
                      field("fixed", &T::fixed, "", "fixed", "by the strand's geometry")};
  }
};

struct FittedLaw {
  LawKind kind = LawKind::linear;
  std::string formula;  ///< with numbers
  std::vector<LawParameter> parameters;
  MatrixXd covariance;             ///< covariance of the free parameters in their order
  double reference_tension_N = 1;  ///< T0 of the power law
  bool converged = false;
  std::string message;     ///< if not converged, or a parameter is not determined
  double chi_squared = 0;  ///< weighted sum of squares (of relative errors without weights)
  double degrees_of_freedom = 0;
  double rms_relative_error = 0;  ///< rms of the points about the law
  /// NaN when there are too few points for it (n <= k + 1).
  double aicc = kNaN;
  /// Weight among the laws that AICc ranks; NaN when it ranks fewer than two of several.
  double akaike_weight = kNaN;

  double common_relative_std = 0;
  double coverage_factor = 1.96;  ///< for 95 %

  static constexpr std::string_view title = "laws, best first";
  static constexpr auto fields() {
    using T = FittedLaw;
    return std::tuple{
        field("law", &T::kind, "", "law", "linear, square root, power or saturating"),
        field("rms_relative_error", &T::rms_relative_error, "%", "rms", "of the points", 3),
        field("aicc", &T::aicc, "", "AICc", "null where there are too few points", 4),
        field("akaike_weight", &T::akaike_weight, "", "", "among the laws ranked"),
        field("formula", &T::formula, "", "formula", "with numbers"),
        field("parameters", &T::parameters, "", "", "of the formula"),
        field("chi_squared", &T::chi_squared, "", "", "misfit"),
        field("degrees_of_freedom", &T::degrees_of_freedom, "", "", "of the misfit"),
        field("converged", &T::converged, "", "", "false: see message"),
        field("message", &T::message, "", "remark", "why it did not converge")};
  }
};

struct StiffnessPrediction {
  double EI_Nm2 = 0;
  double std = 0;            ///< std of the law
  double low = 0, high = 0;  ///< 95 % band of the law
  VectorXd by_parameter;     ///< d EI / d (free parameter), in the order of the covariance
};

struct StiffnessLaws {
  std::vector<FittedLaw> laws;  ///< best first
  bool decided = false;         ///< the points favour the first one clearly
  std::string sentence;         ///< the choice and its reason in words
  bool weighted = false;        ///< the points' own intervals were used

  static constexpr auto fields() {
    using T = StiffnessLaws;
    return std::tuple{field("decided", &T::decided), field("sentence", &T::sentence)};
  }
};

/// EI by a law at a tension > 0, with its bands, which are NaN where a parameter is not determined.
[[nodiscard]] StiffnessPrediction predict(const FittedLaw& law, double tension_N);

/// Throws std::invalid_argument for fewer than two points, or values that are not positive and
/// finite. Laws with more parameters than points are left out.
[[nodiscard]] StiffnessLaws fit_stiffness_laws(const std::vector<StiffnessPoint>& points,
                                               const StiffnessLawOptions& options = {});

/// u_T of the tension's samples in a test, N; `noise_N` is that of one sample, whose extremes are
/// taken off the range.
[[nodiscard]] double tension_spread(const Ref<const VectorXd>& tension_N, double noise_N);

/// Change of each point's EI, N m2, by its `tension_std_N`: d EI / d T times it. Zero where the
/// tensions lie within 5 % of each other: dEI/dT is not known.
[[nodiscard]] std::vector<double> change_by_tension(const std::vector<StiffnessPoint>& points);

}  // namespace rigfit::ident
