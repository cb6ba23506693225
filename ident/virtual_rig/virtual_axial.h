// Simulates a hanging-mass test: the recorded tension of a cable with a mass after a tap.
//
// The simulation is finer than the lumped M + mc/3 of textbooks: the cable is a continuous elastic
// rod with a massless adapter in series, and the mass also swings as a pendulum. The undamped
// frequency is the first root of
//   w^2 M = k(w),  1/k(w) = 1/km + 1/(EA b cot(b L)),  b = w sqrt(m / EA),
// EA b cot(b L) being the dynamic stiffness of a rod fixed at its other end (Meirovitch,
// Fundamentals of Vibrations, sec. 8.3).
#pragma once

#include <cstdint>

#include "ident/virtual_rig/sensor_model.h"
#include "signal/recording/recording.h"

namespace rigfit::ident {

struct VirtualAxialTest {
  double EA_N = 0;
  double mass_per_length_kg_m = 0;
  double length_m = 0;  ///< length of the cable between its ends
  double hung_mass_kg = 0;
  double adapter_stiffness_N_m = 0;  ///< in series; 0: none
  double damping_ratio = 0;          ///< ratio of the oscillation
  double tap_N_s = 0.5;              ///< impulse on the mass
  double tap_scatter = 0.2;          ///< relative standard deviation from tap to tap
  double swing_rad = 0.01;  ///< pendulum amplitude, its tension ripples at twice its frequency
  double sample_rate_hz = 500;
  double before_s = 0.5;  ///< record before the tap
  double after_s = 3;
  double gravity_m_s2 = 9.80665;
  SensorModel load_cell;
};

struct AxialTruth {
  double frequency_hz = 0;  ///< damped
  double damping_ratio = 0;
};

/// Exact damped frequency of the continuous system. Throws std::invalid_argument for values that
/// are not positive and finite or a damping ratio outside [0, 1).
[[nodiscard]] AxialTruth axial_truth(const VirtualAxialTest& test);

/// One record: channel "tension" in N.
[[nodiscard]] signal::Recording virtual_axial_record(const VirtualAxialTest& test, Random& random);

}  // namespace rigfit::ident
