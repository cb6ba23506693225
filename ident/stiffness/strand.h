// Bounds of a strand's bending stiffness.
//
// EImin = sum_i E pi d_i^4 / 64 (all elements slip), EImax = E pi d_c^4 / 64 (none does).
// Source: Jalali and Rideout 2021, eqs. (20), (21).
#pragma once

namespace rigfit::ident {

struct StrandGeometry {
  double youngs_modulus_Pa = 0;
  int elements = 0;  ///< round wires
  double element_diameter_m = 0;
  double strand_diameter_m = 0;
};

struct StiffnessBounds {
  double EI_min_Nm2 = 0;
  double EI_max_Nm2 = 0;
};

/// Throws std::invalid_argument for values that are not positive and finite.
[[nodiscard]] StiffnessBounds stiffness_bounds(const StrandGeometry& geometry);

}  // namespace rigfit::ident
