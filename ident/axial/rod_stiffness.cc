#include "ident/axial/rod_stiffness.h"

#include <ceres/jet.h>

#include "ident/statistics/numbers.h"
#include "ident/statistics/root.h"

namespace rigfit::ident {

RodStiffness rod_stiffness(const RodOnMass& rod) {
  RodStiffness result;
  const auto told = [](double stiffness) { return stiffness > 0 ? 1 / stiffness : 0; };
  const double adapter = told(rod.adapter_N_m), frame = told(rod.frame_N_m);
  const double whole = rod.omega_squared * rod.mass_kg;
  const double seen = 1 / (1 / whole - adapter);  // what the rod and the frame have together, N/m
  const double inertia = rod.omega_squared * rod.mass_per_length_kg_m * rod.length_m;
  // Smooth, and rising from x = pi / 2, where it is negative, through its largest root.
  const auto over = [&](double kc) { return 1 / rod_compliance(kc, inertia, frame) - seen; };
  const double low = std::max(1e-3 * seen, 4 * inertia / (std::numbers::pi * std::numbers::pi));
  double high = low;
  for (int i = 0; i < 200 && !(over(high) > 0); ++i) high *= 2;
  if (!(seen > 0) || !(inertia >= 0) || !(over(high) > 0)) {
    result.cable_N_m = result.series_N_m = kNaN;
    return result;
  }
  const double kc = result.cable_N_m = root_between(low, high, 4e-16, over);
  result.series_N_m = 1 / (1 / kc + adapter + frame);
  using Jet = ceres::Jet<double, 2>;  // by ln kc, ln inertia
  const Jet K = 1.0 / rod_compliance(kc * exp(Jet(0, 0)), inertia * exp(Jet(0, 1)), Jet(frame));
  result.by_omega_squared = (seen * seen / whole - K.v[1]) / K.v[0];
  result.by_length = -K.v[1] / K.v[0];
  result.misfit_by_omega_squared = 1 - K.v[1] * whole / (seen * seen);
  return result;
}

}  // namespace rigfit::ident
