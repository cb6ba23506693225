// What can be measured on a rig, what each mode says of the parameters, and the covariance that
// follows (formulas in plan.h). Internal to the plan and its tests.
//
// A half-sine hit at a place of the mass-normalised modal displacement phi_l starts a decay of
// amplitude phi_s phi_l F(w) w^k at a sensor, F its spectrum (below), k = 1 for
// accelerations, 0 for velocities, -1 for displacements and axial forces. A mode counts as seen
// where the energy of its decay in one record is 20 dB above the noise's: below some 15 dB no
// estimator reaches the bound (Rife and Boorstyn 1974).
//
// Bounds how well one record of a free decay determines a mode's pole, and the decay's amplitude
// after a hammer hit.
//
//   y(t) = Re(C exp((-a + i w) t)) + e,   0 <= t <= T, fs samples a second, e white of std s
//   var(w) = var(a) = 2 s^2 / (fs |C|^2 (I2 - I1^2 / I0)),   I_k = int_0^T t^k exp(-2 a t) dt
//
// is the Cramer-Rao bound with C unknown, for a mode that is apart from others by more than its
// width and has many periods in T. With x = 2 a T,
//   I2 - I1^2 / I0 = I0 T^2 (1 / x^2 - 1 / (4 sinh^2(x / 2))),   I0 = T (1 - exp(-x)) / x,
// which gives 16 s^2 a^3 / (fs |C|^2) for a long record and 24 s^2 / (fs |C|^2 T^3) without
// damping. Informations of independent records, hits and sensors add up.
// Sources: Yao and Pandit, IEEE Trans. Signal Process. 43 (1995) 878; Rife and Boorstyn, IEEE
// Trans. Inf. Theory 20 (1974) 591.
#pragma once

#include "ident/plan/plan.h"
#include "ident/update/problem/update_problem.h"

namespace rigfit::ident {

struct DecayInformation {
  double pole = 0;    ///< 1 / var(w) = 1 / var(a), s^2
  double energy = 0;  ///< sum of the decay's squared samples over s^2
};

/// `signal_to_noise`: |C| / s. `decay_rate_1_s`: a >= 0. `duration_s`: T > 0. `rate_hz`: fs.
[[nodiscard]] DecayInformation decay_information(double signal_to_noise, double decay_rate_1_s,
                                                 double duration_s, double rate_hz);

/// Magnitude of the Fourier transform of a half-sine pulse, N s:
/// 2 P tau / pi |cos(w tau / 2)| / |1 - (w tau / pi)^2|, P its peak (N), tau its duration (s).
[[nodiscard]] double half_sine_impulse(double peak, double duration_s, double omega);

/// Hammer test in one state: indices of candidates, levels of the options' hits and durations.
struct PlanTest {
  std::size_t state = 0, load = 0;
  std::vector<std::size_t> sensors;
  std::size_t hits = 0, duration = 0;
};

/// Every mode of a state that a test may identify.
struct PlanStateModes {
  std::string failure;              ///< empty: there are modes
  std::vector<PlannedMode> modes;   ///< no standard uncertainties
  std::vector<MatrixXd> amplitude;  ///< by mode: loads x sensors, over the noise
};

struct PlanCandidates {
  UpdateProblem problem;  ///< with the inputs as coordinates
  PlanOptions options;
  VectorXd q = {};  ///< the scenes' own values
  std::vector<PlanStateModes> states = {};
  std::vector<model::Load> loads = {};
  std::vector<model::Sensor> sensors = {};
};

/// Throws what UpdateProblem does, std::invalid_argument for a scene without a hammer.
[[nodiscard]] PlanCandidates plan_candidates(const std::vector<UpdateState>& states,
                                             const std::vector<FreeParameter>& free,
                                             const PlanOptions& options);

/// What tests identify: by state, each mode once.
[[nodiscard]] std::vector<PlannedMode> planned_modes(const PlanCandidates& candidates,
                                                     const std::vector<PlanTest>& tests);

/// Derivatives over standard uncertainties, by coordinate: a row for each frequency and damping
/// ratio, zero where no damping is free.
[[nodiscard]] MatrixXd plan_rows(const PlanCandidates& candidates,
                                 const std::vector<PlannedMode>& modes);

/// Covariance of the parameters' coordinates by `modes` and priors, as an update states it.
/// Directions without information get a standard uncertainty of 1000, so that it is finite.
[[nodiscard]] MatrixXd plan_covariance(const PlanCandidates& candidates,
                                       const std::vector<PlannedMode>& modes);

}  // namespace rigfit::ident
