// The modes that a response is made of: those of the motions that some load drives; how far their
// motion is from linear, and what it costs to leave something out, estimated before or beside the
// response.
//
// The shift of natural frequencies in the most deflected state is found before anything non-linear
// is computed. At the instant t* of greatest strain energy sum omega^2 q^2 / 2 the linear answer's
// elastic forces K u are put on the geometrically exact chain at rest, and once more with the other
// sign; where it settles (a stiff cable does not stretch as the linear shape would have it, it
// pulls), its tangent has the eigenvalues lambda+ and lambda- that the motion meets at its
// extremes. For one mode with V = w^2 q^2/2 + b q^3/3 + c q^4/4 perturbation theory (A. H. Nayfeh
// and D. T. Mook, Nonlinear Oscillations, 1979, section 2.3) gives the frequency of the motion,
//   w_m/w - 1 = 3 c q^2/(8 w^2) - 5 b^2 q^2/(12 w^4)
//             = ((lambda+ + lambda-)/(2 w^2) - 1)/8 - 5/48 ((lambda+ - lambda-)/(2 w^2))^2;
// the shift is the sum of both terms' sizes, weighted by each mode's share of the energy.
//
// In an explicit run with steps of h, in which axial waves are slowed by kappa = h^2/8
// (node_mass.h), the relative error of a mode's frequency omega is
//   (omega h)^4 / 1440                    the scheme itself,
//   kappa omega^2 a / 2                   a: the share of axial stretching in its strain energy,
//   2 kappa w^2 (shift)                   by motion: half of the tension that stretches a moving
//                                         cable comes and goes at 2 w and lags by kappa (2 w)^2;
//                                         w^2 is the mean by energy of the modes that stretch it,
//                                         or omega^2 itself where that is more,
// weighted by what the sensors read of a mode.
#pragma once

#include "model/algebra/numbers.h"
#include "model/linear/modes.h"
#include "model/response/linear_answer.h"

namespace rigfit::model {

/// Equilibrium and matrices of every motion; modes only of those that a load drives (of the first
/// when none does): all up to 400 unknowns a motion, else the lowest 200. `segments` by member;
/// empty: the scene's own, 30 where it says "auto". `order` stays empty.
[[nodiscard]] ChainModes response_modes(const Scene& scene, const std::vector<int>& segments);

struct Nonlinearity {
  double frequency_shift = 0;  ///< relative; 1 when no deflected equilibrium was found
  /// Frequency of the mode with most of the energy among the lowest.
  double frequency_at_rest_hz = 0;
  double frequency_moving_hz = 0;  ///< its estimate in motion
  double upper_frequency_hz = 0;   ///< modes up to here hold 99 % of the energy
  double energy_J = 0;             ///< strain energy of the linear answer there
};
/// `assembly`: of the motion that the loads drive (in_plane or space).
[[nodiscard]] Nonlinearity estimate_nonlinearity(const LinearAnswer& answer, const Scene& scene,
                                                 const std::vector<LoadForce>& forces,
                                                 double duration_s, const Assembly& assembly);

/// Error of the modes' frequencies by segments, weighted by their energy: from twice as many,
/// second order.
[[nodiscard]] double resolution_error(const Scene& scene, const LinearAnswer& answer);

/// Members that say "auto" get as many segments, all the same number, as bring that error below the
/// scene's accuracy: 30 to 400.
[[nodiscard]] LinearAnswer choose_response_segments(const Scene& scene,
                                                    const std::vector<LoadForce>& forces,
                                                    double duration_s);

struct StepErrors {
  double scheme = 0;        ///< relative, in frequency
  double slowed_axial = 0;  ///< relative, in frequency
};
/// `shift`: of frequencies by the motion; `kappa` zero: no wave is slowed.
[[nodiscard]] StepErrors explicit_step_errors(const LinearAnswer& answer, double shift,
                                              double step_s, double kappa);

/// Largest step, the sampling interval over a whole number, at which explicit steps with axial
/// waves slowed keep both errors below `accuracy`; zero when none of 1 to 64 does.
[[nodiscard]] double slowed_step(const LinearAnswer& answer, double shift, double interval_s,
                                 double accuracy);

/// Interval T at which modal dampers act in an explicit run: a sample (in a longer one the phase at
/// which a hit comes would show), or a sixteenth of a period of `upper_hz`, below which 99 % of the
/// motion's energy lies, or less: a mode's frequency errs by (zeta omega T)^2 / 6, relative, less
/// than a third of `accuracy` by what sensors read up to half of the sampling rate.
[[nodiscard]] double damper_interval(const LinearAnswer& answer, double upper_hz, double sample_s,
                                     double accuracy);

/// Root-mean-square part of what the sensors read that lies in modes beyond those found, by the
/// fall of amplitudes (1 / omega^2 in displacement) over the upper half of those that were. One
/// when it cannot be said.
[[nodiscard]] double truncated_part(const LinearAnswer& answer, const Scene& scene);

}  // namespace rigfit::model
