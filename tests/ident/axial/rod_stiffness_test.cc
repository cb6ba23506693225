#include "ident/axial/rod_stiffness.h"

#include "tests/test.h"

namespace rigfit::ident::rod_stiffness_test {

// Lowest frequency of mass, rod and frame by the transfer matrix of the rod, by bisection:
// at the top the frame's force kf u0, below u' EA = kf u0; at the bottom W M u = EA u'.
double omega_squared(double kc, double mc, double M, double kf, double km) {
  const double quarter_wave = std::pow(kPi / 2, 2) * kc / mc;  // without the mass
  double low = 0, high = std::min(2 * kc / M, quarter_wave);
  for (int i = 0; i < 200; ++i) {
    const double W = 0.5 * (low + high), x = std::sqrt(W * mc / kc);
    const double u = std::cos(x) + kf / kc * std::sin(x) / x;  // relative to u0
    const double force = kc * (-x * std::sin(x)) + kf * std::cos(x);
    (force > W * M * (u + force / km) ? low : high) = W;
  }
  return low;
}

TEST(RodStiffness, InvertsTheRodFromFeatherToFarHeavierThanItsMass) {
  constexpr double kRigid = 1e18;
  for (const double per_length : {1e-9, 1e-4, 0.16667, 1.0, 5.0, 100.0}) {
    for (const double frame : {5e5, 5e6, kRigid}) {
      for (const double adapter : {2e6, kRigid}) {
        const double kc = 1.6e5, L = 1.3;
        const double W = omega_squared(kc, per_length * L, 2.2, frame, adapter);
        const auto told = [&](double k) { return k == kRigid ? 0 : k; };
        const auto k = rod_stiffness({W, 2.2, per_length, L, told(adapter), told(frame)});
        // Both round to some 1e-15; what cancels in 1/k less the told compliances costs ten of
        // those, near x = pi/2 (cable 60 times the mass) the small difference kr a hundred.
        EXPECT_NEAR(k.cable_N_m, kc, 1e-12 * kc) << per_length << " " << frame << " " << adapter;
        EXPECT_NEAR(k.series_N_m, 1 / (1 / kc + 1 / frame + 1 / adapter), 1e-6);
      }
    }
  }
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

TEST(RodStiffness, AnAdapterOrFrameSofterThanTheWholeHasNoAnswer) {
  EXPECT_TRUE(std::isnan(rod_stiffness({1e5, 2.2, 0.1, 1, 2e5}).cable_N_m));
  EXPECT_TRUE(std::isnan(rod_stiffness({1e5, 2.2, 0.1, 1, 0, 2e5}).cable_N_m));
}

}  // namespace rigfit::ident::rod_stiffness_test
