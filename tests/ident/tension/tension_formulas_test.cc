#include "ident/tension/tension_formulas.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigfit::ident::tension_formulas_test {
namespace {

constexpr double kPi = 3.14159265358979323846;

TEST(TensionFormulas, PinnedBeamIsExact) {
  // f_n^2 = n^2 T / (4 m L^2) + n^4 pi^2 EI / (4 m L^4).
  const double L = 3.2, m = 1.7, EI = 42, T = 1234;
  for (int n : {1, 2, 5}) {
    const double f = std::sqrt(n * n * T / (4 * m * L * L) +
                               std::pow(n, 4) * kPi * kPi * EI / (4 * m * std::pow(L, 4)));
    EXPECT_NEAR(pinned_beam_tension({n, f, L, m, EI}), T, 1e-9 * T);
  }
}

TEST(TensionFormulas, ClampedBeamWithoutTensionAndAsAString) {
  // Without tension the wave numbers times L are 4.730041, 7.853205, 10.995608 (Blevins, 1979): the
  // formula's tension is then small beside EI / L^2 (10^-6 in the wave number is 10^-5 in the
  // tension over EI / L^2).
  const double L = 2, m = 3, EI = 50;
  const double wave[] = {4.730040745, 7.853204624, 10.995607838};
  for (int n = 1; n <= 3; ++n) {
    const double b = wave[n - 1] * (1 + 1e-7);  // a little above, so that the tension is positive
    const double f = b * b / (2 * kPi * L * L) * std::sqrt(EI / m);
    EXPECT_NEAR(clamped_beam_tension({n, f, L, m, EI}) * L * L / EI, 0, 1e-4);
    EXPECT_TRUE(std::isnan(clamped_beam_tension({n, 0.99 * f, L, m, EI})));
  }
  // A long cable: f = (n / 2 L) sqrt(T / m) (1 + 2 / xi + ...), xi = L sqrt(T / EI) = 1000: next
  // order 1e-5.
  const double T = 1e6 * EI / (L * L);
  const double f = 0.5 / L * std::sqrt(T / m) * (1 + 2e-3 + (4 + kPi * kPi / 2) * 1e-6);
  EXPECT_NEAR(clamped_beam_tension({1, f, L, m, EI}) / T, 1, 1e-6);
}

TEST(TensionFormulas, ZuiAgreesWithTheClampedBeam) {
  // Their polynomials were fitted to clamped cables, good to about 1 % for xi above 17 and 4 %
  // below.
  const double L = 10, m = 30, EI = 2e5;
  for (double xi : {5.0, 10.0, 30.0, 100.0}) {
    const double T = xi * xi * EI / (L * L);
    double low = 0.1, high = 1000;  // the frequency by bisection of the exact formula
    for (int i = 0; i < 100; ++i) {
      const double f = 0.5 * (low + high), here = clamped_beam_tension({1, f, L, m, EI});
      (here > T ? high : low) = f;
    }
    EXPECT_NEAR(zui_tension({1, low, L, m, EI}) / T, 1, xi > 17 ? 0.01 : 0.04) << "xi " << xi;
  }
  EXPECT_TRUE(std::isnan(zui_tension({2, 1, L, m, EI})));
}

}  // namespace
}  // namespace rigfit::ident::tension_formulas_test
