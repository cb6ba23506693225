#include "ident/axial/rod_stiffness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rigfit::ident::rod_stiffness_test {
namespace {

// omega^2 of mass, adapter and rod by bisection of the frequency equation: the model forwards.
double omega_squared(double kc, const RodOnMass& rod) {
  double low = 0, high = 1e4;
  const double mc = rod.mass_per_length_kg_m * rod.length_m;
  if (mc > 0) high = std::min(high, 0.5 * std::numbers::pi * std::sqrt(kc / mc));
  for (int i = 0; i < 200; ++i) {
    const double w = 0.5 * (low + high), x = w * std::sqrt(mc / kc);
    const double kr = x > 0 ? kc * x / std::tan(x) : kc;
    const double k = rod.adapter_N_m > 0 ? 1 / (1 / kr + 1 / rod.adapter_N_m) : kr;
    (w * w * rod.mass_kg < k ? low : high) = w;
  }
  return low * low;
}

TEST(RodStiffness, InvertsTheContinuousRodFromFeatherToFarHeavierThanItsMass) {
  for (const double per_length : {0.0, 1e-6, 1e-3, 0.16667, 5.0, 100.0}) {
    for (const double adapter : {0.0, 5e5, 2e6}) {
      RodOnMass rod{0, 2.2, per_length, 1.3, adapter};
      rod.omega_squared = omega_squared(1.6e5, rod);
      const auto k = rod_stiffness(rod);
      // Bisection and inversion round to some 1e-15; near x = pi/2 (cable 60 times the mass) kr is
      // the small difference that costs a hundred of those.
      EXPECT_NEAR(k.cable_N_m, 1.6e5, 1e-12 * 1.6e5) << per_length << " " << adapter;
      EXPECT_NEAR(k.series_N_m, adapter > 0 ? 1 / (1 / 1.6e5 + 1 / adapter) : 1.6e5, 1e-6);
    }
  }
}

TEST(RodStiffness, IsTheThirdOfTheMassToFirstOrderAndItsShareBehindAnAdapter) {
  const double m = 1e-3, L = 1.0, M = 2.2, W = 1e5;
  const auto rigid = rod_stiffness({W, M, m, L, 0});
  // Relative remainder (m L / M)^2 / 45.
  EXPECT_NEAR(rigid.cable_N_m, W * (M + m * L / 3), 5e-9 * W * M);
  const double km = 4e5;
  const auto soft = rod_stiffness({W, M, m, L, km});
  const double share = 1 - soft.series_N_m / km;
  EXPECT_NEAR(soft.series_N_m, W * (M + m * L / 3 * share * share), 1e-7 * W * M);
}

TEST(RodStiffness, DerivativesAreDifferenceQuotients) {
  for (const double per_length : {1e-6, 0.16667, 5.0}) {
    const RodOnMass rod{9.5e4, 2.2, per_length, 1.3, 6e5};
    const auto k = rod_stiffness(rod);
    const auto slope = [&](double RodOnMass::*input) {
      const double h = 1e-5;
      RodOnMass up = rod, down = rod;
      up.*input *= 1 + h, down.*input *= 1 - h;
      return std::log(rod_stiffness(up).cable_N_m / rod_stiffness(down).cable_N_m) /
             std::log((1 + h) / (1 - h));
    };
    // h^2 and rounding over h: 1e-10; ten of them.
    EXPECT_NEAR(k.by_omega_squared, slope(&RodOnMass::omega_squared), 1e-9);
    EXPECT_NEAR(k.by_length, slope(&RodOnMass::length_m), 1e-9);
  }
}

TEST(RodStiffness, AnAdapterSofterThanTheWholeHasNoAnswer) {
  EXPECT_TRUE(std::isnan(rod_stiffness({1e5, 2.2, 0.1, 1, 2e5}).cable_N_m));
}

}  // namespace
}  // namespace rigfit::ident::rod_stiffness_test
