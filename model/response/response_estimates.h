// What it costs to leave something out of a response, estimated before or beside it.
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

#include "model/response/response_modes.h"

namespace rigfit::model {

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
