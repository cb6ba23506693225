// The modes that a response is made of: those of the motions that some load drives, how much each
// matters, and what it costs to leave something out, estimated before or beside the response.
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

/// What each mode and each pole of a linear answer has of the motion after the last force.
struct ModeWeights {
  VectorXd energy;         ///< by mode: share of the energy
  double mean_omega2 = 0;  ///< (rad/s)^2, by energy and its mean over the duration
  /// By pole: share of what the sensors read (mean square over the duration, decay included, each
  /// sensor in its own quantity and counting the same).
  VectorXd sensors;
  std::vector<int> mode_of_pole;
};
[[nodiscard]] ModeWeights mode_weights(const LinearAnswer& answer, const Scene& scene,
                                       const std::vector<const ForceHistory*>& records,
                                       double duration_s);

struct ResponseResolution {
  ChainModes modes;
  LinearAnswer answer;
  double relative_error = 0;  ///< error of the modes' frequencies, weighted by their energy
};

/// The frequencies' error by segments: from twice as many, second order; weighted by energy.
[[nodiscard]] double resolution_error(const Scene& scene, const ChainModes& modes,
                                      const LinearAnswer& answer, const ModeWeights& weights);

/// Members that say "auto" get as many segments, all the same number, as bring that error below the
/// scene's accuracy: 30 to 400.
[[nodiscard]] ResponseResolution choose_response_segments(
    const Scene& scene, const std::vector<const ForceHistory*>& records, double duration_s);

struct StepErrors {
  double scheme = 0;        ///< relative, in frequency
  double slowed_axial = 0;  ///< relative, in frequency
};
/// `shift`: of frequencies by the motion (nonlinearity.h); `kappa` zero: no wave is slowed.
[[nodiscard]] StepErrors explicit_step_errors(const ChainModes& modes, const LinearAnswer& answer,
                                              const ModeWeights& weights, double shift,
                                              double step_s, double kappa);

/// Largest step, the sampling interval over a whole number, at which explicit steps with axial
/// waves slowed keep both errors below `accuracy`; zero when none of 1 to 64 does.
[[nodiscard]] double slowed_step(const ChainModes& modes, const LinearAnswer& answer,
                                 const ModeWeights& weights, double shift, double interval_s,
                                 double accuracy);

/// Interval T at which modal dampers act in an explicit run: a sample (in a longer one the phase at
/// which a hit comes would show), or a sixteenth of a period of `upper_hz`, below which 99 % of the
/// motion's energy lies, or less: a mode's frequency errs by (zeta omega T)^2 / 6, relative, less
/// than a third of `accuracy` by what sensors read up to half of the sampling rate.
[[nodiscard]] double damper_interval(const LinearAnswer& answer, const ModeWeights& weights,
                                     double upper_hz, double sample_s, double accuracy);

/// Root-mean-square part of what the sensors read that lies in modes beyond those found, by the
/// fall of amplitudes (1 / omega^2 in displacement) over the upper half of those that were. One
/// when it cannot be said.
[[nodiscard]] double truncated_part(const LinearAnswer& answer, const ModeWeights& weights,
                                    const Scene& scene);

}  // namespace rigfit::model
