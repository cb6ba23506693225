// Flexural rigidity EI of a clamped, tensioned span from its mid-span compliance d/Q.
//
//   4 P d / (Q l) = F(lambda) = 1 - 2 tanh(lambda / 2) / lambda,   lambda = sqrt(P l^2 / (4 EI))
//
// P tension, l clear span between the clamps, Q load at mid-span, d deflection there; small
// deflections, Euler-Bernoulli. F -> lambda^2 / 12 (d = Q l^3 / (192 EI)) for small lambda and
// F -> 1 (a string, which carries no information on EI) for large lambda.
// Source: Jalali and Rideout 2021, eqs. (17)-(19), whose form suffers from cancellation and
// overflow.
//
// Without tension EI = L^3 / (c s), s = d / Q, the limit for tension zero, with c = 192 clamped, 48
// pinned (load at mid-span), 3 cantilever (load at its end); no shear. Source: Gere and Timoshenko,
// Mechanics of Materials, appendix G.
//
// F is evaluated without cancellation by the continued fraction of tanh (Lambert; Abramowitz and
// Stegun 4.5.70) below lambda = 2 and by 1 - tanh above; both are good to a few units in the last
// place for every positive lambda.
#pragma once

#include "ident/statistics/numbers.h"

namespace rigfit::ident {

enum class BeamEnds {
  tensioned,   ///< clamped at both ends under a measured tension
  clamped,     ///< at both ends, no tension
  pinned,      ///< on two simple supports, no tension
  cantilever,  ///< clamped at one end, loaded at the other; the span is the length to the load
};

[[nodiscard]] const char* name_of(BeamEnds ends);

/// F(lambda), in (0, 1), for lambda > 0; 0 at 0.
[[nodiscard]] double bending_ratio(double lambda);
/// 1 - F(lambda) without cancellation for large lambda.
[[nodiscard]] double bending_ratio_complement(double lambda);

/// Inverts F for a ratio in (0, 1) (throws std::invalid_argument otherwise): Newton on
/// ln(F / (1 - F)) over ln(lambda), which is nearly straight, inside the bracket
/// sqrt(12 F) < lambda < 2 / (1 - F) + 2.
[[nodiscard]] double lambda_from_bending_ratio(double ratio);

/// Deflection at mid-span per unit load, m/N. Tension zero is allowed. Throws
/// std::invalid_argument for EI or span not positive, a negative tension, or a value not finite.
[[nodiscard]] double midspan_compliance(double EI_Nm2, double tension_N, double span_m);

/// EI of a compliance at a tension (of `tensioned` ends); 0 where it is softer than a string,
/// infinite where it does not yield at all.
[[nodiscard]] double EI_of_compliance(double compliance_m_N, double tension_N, double span_m,
                                      BeamEnds ends);

/// k times the relative increase of the compliance by clamps of rotational stiffness k (each, N
/// m/rad), to first order in 1/k: 2 EI tanh^2(lambda / 2) / (l F); without tension 6 EI / l; for a
/// cantilever 3 EI / l.
[[nodiscard]] double clamp_compliance(double EI_Nm2, double tension_N, double span_m,
                                      BeamEnds ends = BeamEnds::tensioned);

/// Measurement at one tension. A standard uncertainty of zero means exactly known, one that is not
/// finite means unknown: then no interval is given.
struct ComplianceMeasurement {
  Estimate compliance_m_N;  ///< slope d/Q
  Estimate tension_N;
  Estimate span_m;
  double degrees_of_freedom = 0;  ///< for the slope's uncertainty (Student's t); 0: normal
  /// For other ends than `tensioned` the tension is ignored, EI = L^3 / (c s).
  BeamEnds ends = BeamEnds::tensioned;
  /// Stiffness of each clamp, N m/rad; 0: rigid. 1 over it is the standard uncertainty of its
  /// flexibility.
  double clamp_stiffness_Nm_rad = 0;
};

enum class BendingStatus {
  solved,
  not_positive,      ///< slope, tension or span are not positive
  string_like,       ///< 4 P d / (Q l) >= 1: softer than a string without any EI
  upper_bound_only,  ///< solved, but the 95 % interval reaches EI = 0
};

struct StiffnessFromBending {
  BendingStatus status = BendingStatus::not_positive;
  std::string reason;   ///< for a person; empty when solved
  double ratio = kNaN;  ///< 4 P d / (Q l)
  double lambda = kNaN;
  /// std is half of the central 68.27 % interval; where a linear formula holds, both agree.
  Estimate EI_Nm2;
  double low = kNaN;   ///< N m^2, 95 % interval
  double high = kNaN;  ///< N m^2; given also for string_like
  /// Relative change of EI per relative change of each input; the first is -1 for a beam without
  /// tension and falls without bound as the ratio approaches 1.
  double log_sensitivity_compliance = kNaN;
  double log_sensitivity_tension = kNaN;
  double log_sensitivity_span = kNaN;
};

/// EI with its interval. The interval propagates the distributions of slope, tension, span and
/// clamps through the equation (4096 Sobol points, the same in every run), so that it also holds
/// where a linear formula does not; draws softer than a string count as EI = 0.
[[nodiscard]] StiffnessFromBending stiffness_from_compliance(const ComplianceMeasurement& measured);

}  // namespace rigfit::ident
