// What theory knows exactly about single cables and beams: truth for the segment model.
//
// Euler-Bernoulli throughout (no shear, no rotary inertia), EI w'''' - T w'' + m w,tt = 0:
//   pinned-pinned     omega_n = (n pi/L) sqrt((T + EI (n pi/L)^2) / m)
//   clamped-clamped   with a^2 - b^2 = T/EI and a b = omega sqrt(m/EI), the halves of the beam give
//                     b tan(bL/2) = -a tanh(aL/2) (symmetric), b cot(bL/2) = a coth(aL/2)
//                     (antisym.) (Bokaian, Journal of Sound and Vibration 142 (1990) 481-498,
//                     factored)
//   cantilever        1 + cos z cosh z + mu z (cos z sinh z - sin z cosh z) = 0, mu = M/(m L)
//                     (Blevins, Formulas for Natural Frequency and Mode Shape, table 8-8)
//   standing column   EI w'''' + ((m g s + M g) w')' = m omega^2 w, s from the tip, by its power
//                     series in s, which converges everywhere (s = 0 is an ordinary point)
//   sagging cable     EI = 0, parabolic profile, quasi-static stretch (Irvine and Caughey,
//                     Proc. R. Soc. Lond. A 341 (1974) 299-315)
//   elastic catenary  exact statics (Irvine, Cable Structures, MIT Press 1981, section 2.2)
//
// Tension is the horizontal component; mass per unstretched length. All SI.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace rigfit::model {

struct UniformBeam {
  double length_m = 0;
  double mass_per_length_kg_m = 0;
  double EI_Nm2 = 0;
  double tension_N = 0;  ///< constant along the beam, not negative
};

// Each returns the first `count` frequencies in Hz, rising.

[[nodiscard]] std::vector<double> pinned_beam_frequencies(const UniformBeam& beam, int count);
[[nodiscard]] std::vector<double> clamped_beam_frequencies(const UniformBeam& beam, int count);

/// `beam.tension_N` must be zero; the tip mass is a point.
[[nodiscard]] std::vector<double> cantilever_frequencies(const UniformBeam& beam,
                                                         double tip_mass_kg, int count);

/// A vertical cantilever clamped at its foot (`gravity` > 0, self-weight softens it) or hanging
/// from it (`gravity` < 0). It must not buckle under its own weight; at most 8 modes (above, the
/// series cancels).
[[nodiscard]] std::vector<double> standing_cantilever_frequencies(const UniformBeam& beam,
                                                                  double tip_mass_kg,
                                                                  double gravity_m_s2, int count);

struct SaggingCable {
  double span_m = 0;
  double mass_per_length_kg_m = 0;
  double EA_N = 0;
  double tension_N = 0;  ///< horizontal component
  double gravity_m_s2 = 9.80665;
};

/// lambda^2 = (m g L/H)^2 EA L / (H Le), Le = L (1 + (m g L/H)^2 / 8).
[[nodiscard]] double irvine_parameter(const SaggingCable& cable);
[[nodiscard]] std::vector<double> irvine_symmetric_frequencies(const SaggingCable& cable,
                                                               int count);
[[nodiscard]] std::vector<double> irvine_antisymmetric_frequencies(const SaggingCable& cable,
                                                                   int count);
[[nodiscard]] std::vector<double> irvine_out_of_plane_frequencies(const SaggingCable& cable,
                                                                  int count);

struct ElasticCatenary {
  double span_m = 0;                 ///< horizontal distance of the ends, positive
  double rise_m = 0;                 ///< the second end above the first
  double weight_per_length_N_m = 0;  ///< per unstretched length, positive
  double EA_N = 0;
};

struct CatenaryState {
  double tension_N = 0;   ///< horizontal component H
  double vertical_N = 0;  ///< upward force of the first support on the cable
  double unstretched_length_m = 0;
  double sag_m = 0;  ///< largest distance below the chord, vertically
};

[[nodiscard]] CatenaryState catenary_of_tension(const ElasticCatenary& cable, double tension_N);
[[nodiscard]] CatenaryState catenary_of_length(const ElasticCatenary& cable,
                                               double unstretched_length_m);
/// Position (x, y) from the first end at the unstretched arc length s.
[[nodiscard]] Eigen::Vector2d catenary_point(const ElasticCatenary& cable,
                                             const CatenaryState& state, double s_m);

}  // namespace rigfit::model
