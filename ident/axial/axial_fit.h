// Axial stiffness of a cable from the undamped frequency of a mass that hangs on it.
//
// The cable is an elastic rod with its own mass m L under a frame kf, above an adapter km (both
// massless springs) and the mass M. With W = omega^2, x^2 = W m L / kc and kc = EA / L:
//   W M = K,   1/K = 1/km + (T + r) / (kc (1 - x^2 T r)),   T = tan(x) / x,   r = kc / kf
// (Meirovitch, Fundamentals of Vibrations, sec. 8.3). For rigid frame and adapter this is
// kc = W (M + m L / 3) to first order in m L / M.
//
// EA of a cable, and a compliance in series, from the frequencies at several lengths: one problem.
//
// At length i the undamped frequency solves W M = K (above), where the compliance s that
// is not told lies above the cable with its part 1 - q and below it with its part q. Least squares
// by Ceres over ln EA and s; hung mass, mass per length, every length, adapter, frame, the sample
// rate and q are parameters with a prior each, so that what all lengths share is shared. All are
// functions of a standard normal: q is its distribution function (uniform between the cable's two
// ends), masses and stiffnesses are exponential in it. s is free, or has a normal prior about zero.
//
// The residual of length i is the error of ln W over its standard deviation, to which `between_std`
// adds a scatter of ln EA from length to length. The covariance is that of the whole problem; each
// residual's share in the variance of ln EA is a row of the budget, and the change of ln EA by a
// prior is the sensitivity. An input without a standard uncertainty enters with 1e-7 of its value.
#pragma once

#include <span>

#include "ident/statistics/numbers.h"

namespace rigfit::ident {

/// 1/K without the adapter: what gives way under the mass, from the rod's static stiffness kc, its
/// inertia W m L and the compliance above it. Scalar: double or ceres::Jet.
template <class T>
T rod_compliance(const T& kc, const T& inertia, const T& above) {
  using std::sqrt, std::tan;
  const T q = inertia / kc;
  T t = 1.0 + q / 3.0 + q * q * (2.0 / 15);  // next term below 1e-13 where q < 1e-4
  if (!(q < 1e-4)) {
    const T x = sqrt(q);
    t = tan(x) / x;
  }
  const T r = kc * above;
  return (t + r) / (kc * (1.0 - q * t * r));
}

struct RodOnMass {
  double omega_squared = 0;         ///< undamped oscillation, 1/s^2
  double mass_kg = 0;               ///< M
  double mass_per_length_kg_m = 0;  ///< m; 0: massless
  double length_m = 0;
  double adapter_N_m = 0;  ///< km; 0: rigid
  double frame_N_m = 0;    ///< kf; 0: rigid
};

struct RodStiffness {
  /// kc; NaN when adapter and frame are together softer than what was measured.
  double cable_N_m = 0;
  double series_N_m = 0;                       ///< static, adapter and frame included
  double by_omega_squared = 0, by_length = 0;  ///< d ln kc / d ln input
  double misfit_by_omega_squared = 0;          ///< d ln(W M / K) / d ln W, where kc stays
};

/// Solved to rounding by Brent's method (GSL) on the frequency equation without its poles.
[[nodiscard]] RodStiffness rod_stiffness(const RodOnMass& rod);

struct AxialSetup {
  Estimate mass_kg{0, 0};               ///< hung, adapter and clamp included; one for all
  Estimate mass_per_length_kg_m{0, 0};  ///< cable; 0: massless
  /// Standard uncertainty of a length, m; independent between lengths (each is cut and
  /// measured anew). Not given: the uncertainty of EA is unknown.
  std::optional<double> length_std_m;
  /// Std of the sample rate, common to all frequencies.
  double rate_relative_std = 0;
  Estimate adapter_stiffness_N_m{0, 0};  ///< in series, below; 0: rigid
  Estimate frame_stiffness_N_m{0, 0};    ///< in series, above; 0: rigid
  /// The user states that the frame is as above (0: rigid), so that one length gives EA. Several
  /// lengths test this statement.
  bool frame_stated = false;
  /// Standard uncertainty of other compliance in series, m/N, about zero. 0: known to be rigid; not
  /// given: unknown, so that several lengths are needed.
  std::optional<double> series_compliance_std_m_N;
  /// Expected EA, N; 0: metallic area (from the mass per length) times `rope_modulus_Pa`.
  double catalogue_EA_N = 0;
};

/// What the records of one length say.
struct AxialLengthData {
  double length_m = 0;
  double log_omega_squared = 0;      ///< mean of ln W, W in 1/s^2
  double log_omega_squared_std = 0;  ///< std of that mean
};

/// What an input does to EA.
struct BudgetRow {
  std::string source;
  std::string unit;
  double value = 0, std = 0;  ///< value and std of the input; NaN where it is no single number
  double sensitivity = 0;     ///< d EA / d input, N per unit (of all lengths together, where it is
                              ///< each one's)
  double contribution_N = 0;  ///< |sensitivity| std
  double share = 0;           ///< share of the variance of EA
  double degrees_of_freedom = 0;  ///< 0: taken as known (type B)
  char type = 'B';

  static constexpr std::string_view title = "where the uncertainty of EA comes from";
  static bool shown(const BudgetRow& b) { return b.share > 5e-4; }
  static constexpr auto fields() {
    using namespace describe;
    using T = BudgetRow;
    return std::tuple{
        field("source", &T::source, "", "source", "input"),
        field(
            "type", [](const T& b) { return std::string(1, b.type); }, "", "",
            "A: from scatter, B: from what is known of instruments"),
        field("value", &T::value, "", "", "of the input, in `unit`"),
        field("std", &T::std, "", "std", "standard uncertainty of the input, in `unit`", 2),
        field("unit", &T::unit, "", "unit", "of value and std"),
        field("sensitivity_N_per_unit", &T::sensitivity, "", "", "change of EA by the input"),
        field("contribution_N", &T::contribution_N, "N", "contribution", "to the std of EA", 2),
        field("share", &T::share, "%", "share", "of the variance of EA", 2),
        field("degrees_of_freedom",
              where([](const T& b) { return b.degrees_of_freedom > 0; }, &T::degrees_of_freedom),
              "", "", "behind std; left out of what is taken as known")};
  }
};

struct AxialFit {
  bool converged = false;         ///< false: nothing below holds
  double EA_N = 0;                ///< per unit strain, of the cable alone
  double EA_relative_std = 0;     ///< without what stands in for exact inputs
  Estimate compliance_m_N{0, 0};  ///< s
  double chi2 = 0;
  int degrees = 0;                ///< lengths less free parameters
  double between_std = 0;         ///< relative
  std::vector<BudgetRow> budget;  ///< frequency, between lengths, length, then the other inputs
};

/// The cable as a rod, by its frequency under what is told of mass, adapter and frame.
[[nodiscard]] RodStiffness rod_of(const AxialSetup& setup, double omega_squared, double length_m);

/// `series`: with a compliance in series.
[[nodiscard]] AxialFit fit_axial(std::span<const AxialLengthData> lengths, const AxialSetup& setup,
                                 bool series, double between_std = 0);

}  // namespace rigfit::ident
