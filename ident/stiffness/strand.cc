#include "ident/stiffness/strand.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace rigfit::ident {
StiffnessBounds stiffness_bounds(const StrandGeometry& geometry) {
  for (const double value : {geometry.youngs_modulus_Pa, static_cast<double>(geometry.elements),
                             geometry.element_diameter_m, geometry.strand_diameter_m}) {
    if (!(std::isfinite(value) && value > 0)) {
      throw std::invalid_argument("strand geometry: every value must be positive and finite");
    }
  }
  const double factor = geometry.youngs_modulus_Pa * std::numbers::pi / 64;
  return {.EI_min_Nm2 = factor * geometry.elements * std::pow(geometry.element_diameter_m, 4),
          .EI_max_Nm2 = factor * std::pow(geometry.strand_diameter_m, 4)};
}

}  // namespace rigfit::ident
