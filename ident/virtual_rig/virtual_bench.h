// Simulates a hanging-mass test: the recorded tension of a cable with a mass after a tap.
//
// The simulation is finer than the lumped M + mc/3 of textbooks: the cable is a continuous elastic
// rod with a massless adapter in series (axial_fit.h), and the mass also swings as a pendulum.
// The undamped frequency is the first root of w^2 M = K(w).
//
// Simulates a bending test: a clamped cable under tension, loaded at mid-span and unloaded again,
// with load cells for tension and load and an LVDT for the deflection.
//
// The simulation is finer than the fitted straight line: the elastic deflection follows eq. (17)
// with the instantaneous tension, which grows with the deflection (P = P0 + k_frame * 2 d^2 / l),
// and wire friction adds a hysteretic load (Dahl 1968: dq/dd = (q_f / d_f) (1 - q/q_f sign(dd))^i),
// so that loading starts steeper than it goes on and unloading lies below it.
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
  double swing_rad = 0.01;  ///< pendulum amplitude, its tension ripples at twice its frequency
  double sample_rate_hz = 500;
  SensorModel load_cell;
};

/// Exact damped frequency of the continuous system. Throws std::invalid_argument for values that
/// are not positive and finite or a damping ratio outside [0, 1).
[[nodiscard]] double axial_frequency_hz(const VirtualAxialTest& test);

/// One record, from 0.5 s before the tap to 3 s after it: channel "tension" in N.
[[nodiscard]] signal::Recording virtual_axial_record(const VirtualAxialTest& test, Random& random);

struct VirtualBendingTest {
  double EI_Nm2 = 0;  ///< at the tension before loading, with the wires slipping: the truth
  /// d EI / d tension if EI follows the instantaneous tension; 0: EI stays that at rest, as if
  /// friction between wires was set when the cable was tensioned.
  double EI_by_tension_m2 = 0;
  double span_m = 0;
  double tension_N = 0;  ///< before loading
  double peak_load_N = 10;
  double frame_stiffness_N_m = 2e4;  ///< tension gained per metre that the cable shortens its ends
  double friction_load_N = 0.02;     ///< q_f, hysteresis half width
  double friction_travel_m = 5e-5;   ///< d_f, travel over which it builds up
  double friction_exponent = 1;      ///< i of Dahl's law: 0 bilinear, 1 exponential, 2 long tail
  int cycles = 2;                    ///< loading and unloading
  double cycle_s = 60;
  double sample_rate_hz = 20;
  SensorModel tension_cell, load_cell, lvdt;
};

/// Channels "tension" (N), "load" (N), "deflection" (m). Throws std::invalid_argument for values
/// that are not positive and finite.
[[nodiscard]] signal::Recording virtual_bending_record(const VirtualBendingTest& test,
                                                       Random& random);

}  // namespace rigfit::ident
