// EA and axial damping of a cable from hanging-mass tests: a mass M on a length lc of cable is
// struck, and the tension's decay gives the damped frequency wd and the damping ratio zeta.
//
//   omega^2 = wd^2 / (1 - zeta^2)       undamped frequency
//   kc = EA / lc from omega, M, the cable's own mass and the adapter in series (axial_fit.h)
//   c = 2 zeta sqrt(k M)
// Source: Jalali and Rideout 2021, axial test; their approximation of the cable's inertia is
// replaced by the exact rod.
//
// Other compliance in series with the cable (grips, load cell, frame, an adapter that was not
// stated) does not grow with length: with two or more lengths it is a free parameter of the fit
// (axial_fit.h), so that EA follows from the slope of 1/kc over length. One length cannot separate
// the two. Unless the frame is stated, EA then has bounds only (`conditional`): at least its value
// for a rigid frame (one-sided) and at most that of a solid metal bar with the cable's mass per
// length; the standard uncertainty is that of a rectangular density between them (GUM, 4.3.7).
//
// Lengths that disagree (chi-squared of the fit, 5 %) get a scatter of EA by Paule and Mandel, and
// Student's t with the fit's degrees of freedom. Expanded uncertainties from scatter (type A) and
// from other knowledge (type B) are added in squares (R. Willink, Metrologia 44 (2007) 340); 1/EA
// is symmetric. Damping ratios are averaged over records and lengths (estimation/groups.h).
#pragma once

#include <span>

#include "ident/axial/axial_fit.h"
#include "ident/statistics/uncertainty.h"
#include "signal/recording/recording.h"

namespace rigfit::ident {

struct AxialDecay {
  std::string name;  ///< name of the record, for messages
  double length_m = 0;
  Estimate damped_frequency_hz, damping_ratio;
};

struct AxialSample {
  double length_m = 0;
  double stiffness_N_m = 0;        ///< k, static, adapter included
  double cable_stiffness_N_m = 0;  ///< kc
  Estimate EA_N;                   ///< std from the record alone
  double damping_Ns_m = 0;
};

struct AxialLength {
  double length_m = 0;
  int records = 0;
  Estimate EA_N;  ///< std from repeats and this length, not from shared inputs
  Estimate damping_ratio;
  double damping_Ns_m = 0;

  static constexpr std::string_view title = "by length, the cable alone giving way";
  static constexpr auto fields() {
    using T = AxialLength;
    return std::tuple{
        field("length_m", &T::length_m, "m", "length", "between the ends"),
        field("records", &T::records, "", "records", "decays at this length"),
        field("EA_N", &T::EA_N, "N", "EA", "repeats and this length's own uncertainty"),
        field("damping_ratio", &T::damping_ratio, "%", "damping ratio", "mean of the records"),
        field("damping_Ns_m", &T::damping_Ns_m, "N s/m", "damper", "equivalent viscous damper")};
  }
};

struct AxialTestResult {
  /// std and interval NaN where the lengths' uncertainty is not given.
  /// Where it is a bound (`conditional`) without a mass per length, high end and std are infinite.
  BoundedEstimate EA_N;
  double coverage_factor = 0;  ///< half the interval over the standard uncertainty
  /// The lengths cannot separate other compliance: `EA_N` is the value without any, which is a
  /// lower bound; std and interval are those of a bound.
  bool conditional = false;
  BoundedEstimate EA_if_rigid_N;  ///< if `conditional`: EA without other compliance
  /// Static stiffness of the whole chain (cable, adapter, frame) at the one length; 0 for several.
  Estimate assembly_stiffness_N_m;
  /// Compliance in series from the lengths, beside the stated one; NaN: not fitted.
  Estimate series_compliance_m_N;
  BoundedEstimate damping_ratio;
  Estimate damping_Ns_m;          ///< at `reference_length_m`
  double reference_length_m = 0;  ///< mean of the lengths
  std::vector<AxialSample> samples;
  std::vector<AxialLength> lengths;
  std::vector<BudgetRow> budget;  ///< of EA, largest first

  /// Probability of such a disagreement between lengths of the same EA; 1 for too few lengths.
  double homogeneity_p = 1;
  double between_lengths_std_N = 0;  ///< scatter of EA between lengths; 0: they agree (5 %)

  double catalogue_EA_N = 0;      ///< given or from the mass per length; 0: neither
  double share_of_catalogue = 0;  ///< EA over catalogue_EA_N
  std::vector<signal::Note> notes;

  static constexpr std::string_view title = "axial test";
  static constexpr auto fields() {
    using namespace describe;
    using T = AxialTestResult;
    return std::tuple{
        field("EA_N", &T::EA_N, "N", "EA", "axial rigidity"),
        field("EA_if_rigid_N", where(&T::conditional, &T::EA_if_rigid_N), "N",
              "EA if nothing else gives way", "axial rigidity if only the cable gives way"),
        field("damping_ratio", &T::damping_ratio, "%", "damping ratio", "of the axial mode"),
        field("damping_Ns_m", &T::damping_Ns_m, "N s/m", "damper", "at the reference length"),
        field("reference_length_m", &T::reference_length_m, "m", "damper's length",
              "mean of the lengths"),
        field("assembly_stiffness_N_m",
              where([](const T& r) { return r.assembly_stiffness_N_m.value > 0; },
                    &T::assembly_stiffness_N_m),
              "N/m", "stiffness of the whole chain", "cable, adapter and frame at the one length"),
        field("lengths", &T::lengths, "", "lengths", "what each length says"),
        field("p_same_EA", &T::homogeneity_p, "", "p that lengths have one EA",
              "chance of such a disagreement; 1: too few lengths to tell", 2),
        field("budget", &T::budget, "", "budget", "contributions to the std of EA, largest first"),
        field("coverage_factor_95", &T::coverage_factor, "", "", "half the interval over the std"),
        field("between_lengths_std_N", &T::between_lengths_std_N, "N", "",
              "scatter of EA between lengths beyond their own uncertainty"),
        field("series_compliance_m_N",
              where([](const T& r) { return r.series_compliance_m_N.std > 0; },
                    &T::series_compliance_m_N),
              "m/N", "compliance in series", "as the lengths show it: 1/kc = L/EA + s"),
        field("catalogue_EA_N", &T::catalogue_EA_N, "N", "",
              "given or from the mass per length; 0: neither"),
        field("share_of_catalogue", &T::share_of_catalogue, "%", "", "EA over it")};
  }
};

/// Throws std::invalid_argument, naming the record, for values that are not positive and finite,
/// when an adapter is softer than the whole measured chain, and when the lengths cannot be fitted.
/// Notes: one_length, lengths_too_close, lengths_disagree, series_compliance, length_std,
/// massless_cable, exact_inputs, below_catalogue, above_catalogue.
[[nodiscard]] AxialTestResult identify_axial(std::span<const AxialDecay> decays,
                                             const AxialSetup& setup);

}  // namespace rigfit::ident
