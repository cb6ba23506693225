#include "ident/axial/rod_stiffness.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace rigfit::ident {
namespace {

// x in (0, pi/2) of x tan x = y: Newton on x sin x - y cos x, which rises there, kept in a bracket.
double argument_of(double y) {
  double low = 0, high = 0.5 * std::numbers::pi;
  double x = std::sqrt(y / (1 + 4 * y / (std::numbers::pi * std::numbers::pi)));
  for (int i = 0; i < 100; ++i) {
    const double s = std::sin(x), c = std::cos(x);
    const double value = x * s - y * c;
    (value < 0 ? low : high) = x;
    double next = x - value / (s + x * c + y * s);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - x) <= 1e-16 * x) return next;
    x = next;
  }
  return x;
}

// ln(omega^2 M / K(omega)) of a rod of stiffness kc: rises with omega, falls with kc.
double misfit(double kc, const RodOnMass& rod) {
  const double q = rod.omega_squared * rod.mass_per_length_kg_m * rod.length_m / kc;
  const double x = std::sqrt(q);
  const double t = q < 1e-4 ? 1 + q / 3 + q * q * (2.0 / 15) : std::tan(x) / x;
  const double r = kc / rod.frame_N_m;
  double compliance = (t + r) / (kc * (1 - q * t * r));
  if (rod.adapter_N_m > 0) compliance += 1 / rod.adapter_N_m;
  return std::log(rod.omega_squared * rod.mass_kg * compliance);
}

// Under a frame of finite stiffness, below the frequency at which the rod alone swings under it.
RodStiffness under_frame(const RodOnMass& rod) {
  RodStiffness result;
  RodOnMass without = rod;
  without.frame_N_m = 0;
  const double least = rod_stiffness(without).cable_N_m;
  const double seen = rod.omega_squared * rod.mass_kg;
  double rest = 1 / seen - 1 / rod.frame_N_m;
  if (rod.adapter_N_m > 0) rest -= 1 / rod.adapter_N_m;
  if (!(rest > 0) || !(least > 0)) {
    result.cable_N_m = result.series_N_m = std::numeric_limits<double>::quiet_NaN();
    return result;
  }
  // The frame only makes the cable stiffer; doubled until the model is stiffer than what was seen.
  double low = std::log(least), high = low;
  for (int i = 0; i < 60 && !(misfit(std::exp(high), rod) < 0); ++i) high += 0.7;
  for (int i = 0; i < 100 && high - low > 1e-16; ++i) {
    const double middle = 0.5 * (low + high);
    const double value = misfit(std::exp(middle), rod);
    (value < 0 ? high : low) = middle;  // NaN and beyond the pole of the rod: softer still
    if (!std::isfinite(value)) low = middle;
  }
  result.cable_N_m = std::exp(0.5 * (low + high));
  const auto slope = [&](double RodOnMass::*input) {  // of the misfit, by ln of the input
    constexpr double h = 1e-5;
    RodOnMass up = rod, down = rod;
    up.*input *= 1 + h, down.*input *= 1 - h;
    return (misfit(result.cable_N_m, up) - misfit(result.cable_N_m, down)) / (2 * h);
  };
  constexpr double h = 1e-5;
  const double by_kc =
      (misfit(result.cable_N_m * (1 + h), rod) - misfit(result.cable_N_m * (1 - h), rod)) / (2 * h);
  result.by_omega_squared = -slope(&RodOnMass::omega_squared) / by_kc;
  result.by_mass = -slope(&RodOnMass::mass_kg) / by_kc;
  result.by_mass_per_length = -slope(&RodOnMass::mass_per_length_kg_m) / by_kc;
  result.by_length = -slope(&RodOnMass::length_m) / by_kc;
  result.by_adapter = rod.adapter_N_m > 0 ? -slope(&RodOnMass::adapter_N_m) / by_kc : 0;
  double compliance = 1 / result.cable_N_m + 1 / rod.frame_N_m;
  if (rod.adapter_N_m > 0) compliance += 1 / rod.adapter_N_m;
  result.series_N_m = 1 / compliance;
  return result;
}

}  // namespace

RodStiffness rod_stiffness(const RodOnMass& rod) {
  if (rod.frame_N_m > 0) return under_frame(rod);
  RodStiffness result;
  const double seen = rod.omega_squared * rod.mass_kg;
  const bool adapter = rod.adapter_N_m > 0;
  const double rod_seen = adapter ? 1 / (1 / seen - 1 / rod.adapter_N_m) : seen;
  const double inertia = rod.omega_squared * rod.mass_per_length_kg_m * rod.length_m;
  if (!(rod_seen > 0) || !(inertia >= 0)) {
    result.cable_N_m = result.series_N_m = std::numeric_limits<double>::quiet_NaN();
    return result;
  }
  const double y = inertia / rod_seen;
  double by_rod = 1, by_inertia = 0;  // d ln kc / d ln of each
  if (y < 1e-4) {                     // series of x tan x = y; its next term is below 1e-15
    result.cable_N_m = rod_seen * (1 + y / 3 + y * y / 45);
    by_inertia = (y / 3 + 2 * y * y / 45) / (1 + y / 3 + y * y / 45);
    by_rod = 1 - by_inertia;
  } else {
    const double x = argument_of(y);
    result.cable_N_m = inertia / (x * x);
    const double half = 0.5 * std::sin(2 * x);
    by_rod = 2 * half / (x + half);
    by_inertia = (x - half) / (x + half);
  }
  const double by_seen = by_rod * rod_seen / seen;
  result.by_mass = by_seen;
  result.by_omega_squared = by_inertia + by_seen;
  result.by_mass_per_length = result.by_length = by_inertia;
  result.by_adapter = adapter ? -by_rod * rod_seen / rod.adapter_N_m : 0;
  result.series_N_m = adapter ? 1 / (1 / result.cable_N_m + 1 / rod.adapter_N_m) : result.cable_N_m;
  return result;
}

}  // namespace rigfit::ident
