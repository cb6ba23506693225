#include "model/motion/sampling.h"

#include <algorithm>
#include <cmath>

namespace rigfit::model {

void EnergyBalance::add(double potential_J, double kinetic_J, double supplied_J,
                        double dissipated_J) {
  const double left = potential_J + kinetic_J - supplied_J + dissipated_J;
  if (!start_) start_ = left;
  supplied = supplied_J;
  dissipated = dissipated_J;
  kinetic = std::max(kinetic, kinetic_J);
  worst = std::max(worst, std::abs(left - *start_));
}

long SamplingOptions::rows() const {
  return static_cast<long>(std::floor(duration_s * rate_hz * (1 + 1e-12))) + 1;
}

long SamplingOptions::energy_stride() const { return std::max(1L, (rows() - 1) / 20); }

}  // namespace rigfit::model
