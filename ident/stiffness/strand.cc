#include "ident/stiffness/strand.h"

#include <cmath>
#include <initializer_list>
#include <numbers>
#include <stdexcept>

namespace rigfit::ident {
namespace {

void require_positive(std::initializer_list<double> values, const char* what) {
  for (double value : values) {
    if (!(std::isfinite(value) && value > 0)) {
      throw std::invalid_argument(std::string(what) + ": every value must be positive and finite");
    }
  }
}

}  // namespace

StiffnessBounds stiffness_bounds(const StrandGeometry& geometry) {
  require_positive({geometry.youngs_modulus_Pa, static_cast<double>(geometry.elements),
                    geometry.element_diameter_m, geometry.strand_diameter_m},
                   "strand geometry");
  const double factor = geometry.youngs_modulus_Pa * std::numbers::pi / 64;
  return {.EI_min_Nm2 = factor * geometry.elements * std::pow(geometry.element_diameter_m, 4),
          .EI_max_Nm2 = factor * std::pow(geometry.strand_diameter_m, 4)};
}

EquivalentCylinder equivalent_cylinder(double EI_Nm2, double EA_N, double mass_per_length_kg_m) {
  require_positive({EI_Nm2, EA_N, mass_per_length_kg_m}, "equivalent cylinder");
  const double diameter = 4 * std::sqrt(EI_Nm2 / EA_N);
  const double area = std::numbers::pi * diameter * diameter / 4;
  return {.youngs_modulus_Pa = EA_N / area,
          .diameter_m = diameter,
          .density_kg_m3 = mass_per_length_kg_m / area};
}

}  // namespace rigfit::ident
