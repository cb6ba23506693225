// A line of utility poles as a scene file: tapered poles in soil, crossarms, conductors, and in
// each pole a zone whose flexural rigidity a fit can free.
//
// A pole of diameters d_g at the ground and d_t at the top has d(y) linear between, EI = E pi d^4 /
// 64 and mass per length rho pi d^2 / 4. The soil is translational and rotational springs at the
// ground line, or an embedded length on springs k h each (Winkler: k in N/m per m of depth, h the
// depth that one spring stands for). The conductors of a span are one cable of so many times the
// mass, EA, EI and tension, with pinned ends at the pole tops; both end spans go to dead ends.
// Source: E. Winkler, Die Lehre von der Elastizitaet und Festigkeit, 1867; M. Hetenyi, Beams on
// Elastic Foundation, 1946.
#pragma once

#include <string>

namespace rigfit::apps {

struct UtilityLine {
  int poles = 3;
  double height_m = 10;  ///< above ground
  double ground_diameter_m = 0.30, top_diameter_m = 0.20;
  double modulus_Pa = 10e9, density_kg_m3 = 600;  ///< wood along the grain
  double damping_ratio = 0.02;
  /// Springs at the ground line, N/m and N m/rad; unused with an embedded length.
  double soil_translational = 1e7, soil_rotational = 4e6;
  double embedded_m = 0;      ///< 0: springs at the ground line
  double winkler_N_m2 = 2e7;  ///< subgrade reaction times diameter
  int winkler_springs = 4;    ///< along the embedded length
  double crossarm_kg = 60;    ///< with insulators, at the top
  double span_m = 60;
  int conductors = 3;  ///< 0: bare poles
  /// One conductor: ACSR 95/15 or so.
  double conductor_kg_m = 0.38, conductor_EA_N = 8.5e6, conductor_EI_Nm2 = 20;
  double conductor_tension_N = 6000;
  /// Zone of reduced EI of every pole: from `damage_from` to `damage_to` of the height, EI times
  /// 1 - depth in pole 1.
  double damage_from = 0, damage_to = 0.15, damage_depth = 0;
};

/// Scene file with remarks; members "pole1 base", "pole1 shaft" (and "pole1 root" below a zone
/// above the ground), "span1" ..., nodes "ground1", "top1", sensors and a hammer on each pole.
/// Throws std::invalid_argument for numbers that make no sense.
[[nodiscard]] std::string utility_line_scene(const UtilityLine& line);

}  // namespace rigfit::apps
