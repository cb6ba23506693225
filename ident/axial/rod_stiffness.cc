#include "ident/axial/rod_stiffness.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include "ident/statistics/root.h"

namespace rigfit::ident {
namespace {

struct Equation {
  double seen = 0;     // what the rod and the frame have together, N/m
  double inertia = 0;  // W m L
  double above = 0;    // compliance of the frame

  // The frequency equation times kc x cos x: smooth, and rising through its largest root.
  [[nodiscard]] double operator()(double kc) const {
    const double x = std::sqrt(inertia / kc), r = kc * above;
    const double sinc = x > 0 ? std::sin(x) / x : 1;
    return kc * (std::cos(x) - x * r * std::sin(x)) - seen * (sinc + r * std::cos(x));
  }
};

double told(double stiffness) { return stiffness > 0 ? 1 / stiffness : 0; }

Equation equation_of(const RodOnMass& rod, double ln_W = 0, double ln_length = 0) {
  const double W = rod.omega_squared * std::exp(ln_W);
  return {1 / (1 / (W * rod.mass_kg) - told(rod.adapter_N_m)),
          W * rod.mass_per_length_kg_m * rod.length_m * std::exp(ln_length), told(rod.frame_N_m)};
}

}  // namespace

RodStiffness rod_stiffness(const RodOnMass& rod) {
  RodStiffness result;
  const Equation equation = equation_of(rod);
  // At x = pi / 2 the equation is negative, and so it is far below what a massless rod would have.
  double low =
      std::max(1e-3 * equation.seen, 4 * equation.inertia / (std::numbers::pi * std::numbers::pi));
  double high = low;
  for (int i = 0; i < 200 && !(equation(high) > 0); ++i) high *= 2;
  if (!(equation.seen > 0) || !(equation.inertia >= 0) || !(equation(high) > 0)) {
    result.cable_N_m = result.series_N_m = std::numeric_limits<double>::quiet_NaN();
    return result;
  }
  const double kc = result.cable_N_m = root_between(low, high, 4e-16, equation);
  result.series_N_m = 1 / (1 / kc + told(rod.adapter_N_m) + told(rod.frame_N_m));
  constexpr double h = 1e-5;
  const auto slope = [&](auto at) { return at(h) - at(-h); };
  const double by_kc = slope([&](double d) { return equation(kc * std::exp(d)); });
  result.by_omega_squared = -slope([&](double d) { return equation_of(rod, d)(kc); }) / by_kc;
  result.by_length = -slope([&](double d) { return equation_of(rod, 0, d)(kc); }) / by_kc;
  return result;
}

}  // namespace rigfit::ident
