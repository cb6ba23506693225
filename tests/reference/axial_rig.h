// A hanging-mass rig by finite elements: records that share no assumption with the axial test's
// estimator but the physics. A chain of bar elements with consistent masses hangs from a frame
// spring, an adapter spring below it holds the mass; every axial mode up to the fifth swings after
// the tap, damped more the higher it is. The load cell above the cable sees besides the mass's
// pendulum (to second order, with a part that leaks at its own frequency), mains hum, noise and the
// steps of its converter.
#pragma once

#include <vector>

#include "ident/virtual_rig/sensor_model.h"
#include "signal/recording/recording.h"

namespace rigfit::reference {

struct AxialRig {
  double EA_N = 205000, mass_per_length_kg_m = 0.16667, length_m = 1, mass_kg = 2.2;
  double damping_ratio = 0.017;
  double frame_N_m = 0, adapter_N_m = 0;  ///< 0: rigid
  double pendulum_rad = 0;                ///< amplitude
  double hum_N = 0;                       ///< amplitude, within 0.05 Hz of 50 Hz
  double noise_N = 1, step_N = 0.05, tap_N_s = 0.5;
  double sample_rate_hz = 500, before_s = 0.2, after_s = 1.5;
};

/// Channel "tension", N.
[[nodiscard]] signal::Recording axial_rig_record(const AxialRig& rig, ident::Random& random);

struct AxialStudy {
  AxialRig rig;
  std::vector<double> lengths_m;
  int taps = 3;
  double mass_std_kg = 0.003, length_std_m = 0.001, per_length_std = 0.001;
  double frame_told_relative_std = 0;  ///< the rig's frame is told, drawn off by this; 0: not told
};

struct AxialCoverage {
  int campaigns = 0;
  int refused = 0;                    ///< no EA
  int covered = 0;                    ///< EA within its interval
  int silently_wrong = 0;             ///< missed, without any of the warnings about the lengths
  int warned = 0;                     ///< with one of these warnings
  double relative_std = 0, bias = 0;  ///< means: of std / EA, of (EA - truth) / std
};

/// How often the axial test's intervals hold the truth, over rigs drawn from their uncertainties.
[[nodiscard]] AxialCoverage axial_coverage(const AxialStudy& study, int campaigns, unsigned seed);

}  // namespace rigfit::reference
