#include "ident/tension/cable_frequencies.h"

#include "ident/tension/cable_model.h"
#include "tests/test.h"

namespace rigfit::ident::cable_frequencies_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(CableFrequencies, PinnedBeamIsTheClosedForm) {
  // f_n^2 = n^2 T / (4 m L^2) + n^4 pi^2 EI / (4 m L^4).
  const double L = 3.2, m = 1.7, EI = 42, T = 1234;
  const auto f = cable_frequencies({L, m, T, EI, 0, 0}, 6, kInf);
  ASSERT_EQ(f.out_hz.size(), 6u);
  EXPECT_EQ(f.in_hz, f.out_hz);
  for (int n = 1; n <= 6; ++n) {
    const double exact = std::sqrt(n * n * T / (4 * m * L * L) +
                                   std::pow(n, 4) * kPi * kPi * EI / (4 * m * std::pow(L, 4)));
    EXPECT_NEAR(f.out_hz[static_cast<std::size_t>(n - 1)], exact, 1e-12 * exact);
  }
}

TEST(CableFrequencies, OneEndPinnedTheOtherClampedWithoutTension) {
  // Wave numbers times L: 3.926602, 7.068583, 10.210176, 13.351769 (Blevins, 1979).
  const double wave[] = {3.926602312, 7.068582746, 10.210176123, 13.351768778};
  SaggingBeam beam{2, 3, 1e-9 * 50 / 4, 50, kInf, 0};
  beam.first_pinned = true;
  const auto f = cable_frequencies(beam, 4, kInf);
  ASSERT_EQ(f.in_hz.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(f.in_hz[i] / (wave[i] * wave[i] / (2 * kPi * 4) * std::sqrt(50.0 / 3)), 1, 1e-8);
  }
  // A soft spring is a pin there too.
  beam = {2, 3, 10, 50, 1e-8, 0};
  beam.first_pinned = true;
  const auto soft = cable_frequencies(beam, 3, kInf),
             pinned = cable_frequencies({2, 3, 10, 50, 0, 0}, 3, kInf);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(soft.in_hz[i] / pinned.in_hz[i], 1, 1e-8);
}

TEST(CableFrequencies, ClampedBeamWithoutTension) {
  // Wave numbers times L of a clamped beam: 4.730041, 7.853205, 10.995608, 14.137165 (Blevins,
  // 1979). T L^2 / EI = 1e-9 changes them by 1e-10.
  const double wave[] = {4.730040745, 7.853204624, 10.995607838, 14.137165491};
  const auto f = cable_frequencies({2, 3, 1e-9 * 50 / 4, 50, kInf, 0}, 4, kInf);
  for (std::size_t i = 0; i < 4; ++i) {
    const double exact = wave[i] * wave[i] / (2 * kPi * 4) * std::sqrt(50.0 / 3);
    EXPECT_NEAR(f.in_hz[i] / exact, 1, 1e-8);
  }
  // A very stiff spring is a clamp, a very soft one a pin.
  const auto stiff = cable_frequencies({2, 3, 10, 50, 1e10, 0}, 3, kInf);
  const auto clamped = cable_frequencies({2, 3, 10, 50, kInf, 0}, 3, kInf);
  const auto soft = cable_frequencies({2, 3, 10, 50, 1e-8, 0}, 3, kInf);
  const auto pinned = cable_frequencies({2, 3, 10, 50, 0, 0}, 3, kInf);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(stiff.in_hz[i] / clamped.in_hz[i], 1, 1e-7);
    EXPECT_NEAR(soft.in_hz[i] / pinned.in_hz[i], 1, 1e-9);
  }
}

TEST(CableFrequencies, SagIsIrvinesEquation) {
  // Without bending tan(x) = x - (4 / lambda^2) x^3, x = b L / 2, in symmetric modes; antisymmetric
  // ones stay. At 2e7 L sqrt(T / EI) the bending's part is 1e-7.
  const double L = 100, m = 10, T = 1e5, EI = T * L * L * 2.5e-15;
  for (const double lambda2 : {0.1, 10.0, 39.0, 41.0, 200.0}) {
    const auto f = cable_frequencies({L, m, T, EI, 0, lambda2}, 6, kInf);
    ASSERT_EQ(f.in_hz.size(), 6u);
    int symmetric = 0;
    for (const double hz : f.in_hz) {
      const double x = 2 * kPi * hz * std::sqrt(m / T) * L / 2;
      if (std::abs(std::sin(x)) < 1e-6) continue;
      ++symmetric;
      const double misfit = std::sin(x) - (x - 4 / lambda2 * x * x * x) * std::cos(x);
      EXPECT_NEAR(misfit, 0, 1e-5 * (1 + 4 / lambda2 * x * x * x)) << lambda2 << ", x = " << x;
    }
    EXPECT_EQ(symmetric, 3) << lambda2;
    // Families at even and odd places, each rising.
    for (std::size_t i = 2; i < f.in_hz.size(); ++i) EXPECT_GT(f.in_hz[i], f.in_hz[i - 2]);
    EXPECT_EQ(f.in_hz[1], f.out_hz[1]);
    // The first symmetric mode rises above the first antisymmetric one at lambda = 2 pi.
    EXPECT_EQ(f.in_hz[0] > f.in_hz[1], lambda2 > 4 * kPi * kPi) << lambda2;
  }
}

TEST(CableFrequencies, ASaggingStiffCableIsTheSegmentModels) {
  // The static curve's bending counts: without it the first mode is off by a hundredth. What is
  // left is of the order of the slope squared, (w L / T)^2 / 20 here.
  for (const CableEnds ends : {CableEnds::pinned, CableEnds::springs, CableEnds::clamped}) {
    const CableDescription cable{.length_m = {50, 0},
                                 .mass_per_length = {1, 0},
                                 .mass_reference = MassReference::unstretched,
                                 .EA_N = signal::Estimate{4e6, 0}};
    const double T = 6000, EI = T * 50 * 50 / 49, slope = 9.80665 * 50 / T;
    double spring = ends == CableEnds::pinned ? 0 : kInf;
    if (ends == CableEnds::springs) spring = EI * 11 / 50;
    std::string why;
    const auto correction = segment_correction(CableModel(cable), ends, {T, EI, spring}, 6, why);
    ASSERT_EQ(correction.in.size(), 6u) << why;
    for (const double ln : correction.in) EXPECT_NEAR(ln, 0, slope * slope / 10) << name_of(ends);
  }
}

TEST(CableFrequencies, StopsBeyondTheLimit) {
  const auto f = cable_frequencies({1, 1, 4, 1e-9, 0, 0}, 100, 4.5);  // 1, 2, 3 ... Hz
  ASSERT_EQ(f.out_hz.size(), 5u);
  EXPECT_NEAR(f.out_hz.back(), 5, 1e-5);
}

TEST(CableFrequencies, FromTheRootsOfANeighbourOrFromNone) {
  // Roots to 1e-13: neighbours far and near, from no sag to deep sag, pinned to clamped.
  CableRoots roots;
  for (const double lambda2 : {0.0, 1e-9, 1e-3, 1.0, 39.0, 40.0, 700.0, 1e5}) {
    for (const double spring : {0.0, 1.0, 1e4, kInf}) {
      for (const double EI : {1e-4, 1.0, 1.01, 30.0}) {
        const SaggingBeam cable{2, 3, 50, EI, spring, lambda2};
        const auto cold = cable_frequencies(cable, 9, kInf);
        const auto warm = cable_frequencies(cable, 9, kInf, &roots);
        ASSERT_EQ(cold.in_hz.size(), warm.in_hz.size());
        for (const auto& [a, b] : {std::pair(cold.in_hz, warm.in_hz), {cold.out_hz, warm.out_hz}}) {
          for (std::size_t i = 0; i < a.size(); ++i) {
            EXPECT_NEAR(b[i] / a[i], 1, 1e-11) << lambda2 << ' ' << spring;
          }
        }
      }
    }
  }
}

TEST(CableFrequencies, SagBelowRoundingMovesNoMode) {
  // lambda^2 = 1.2e-9 of a stiff beam: the root lies nearer to its neighbour than the misfit's
  // rounding tells.
  const SaggingBeam cable{10, 2, 1e4, 1e6 / 3.1228, 77.3 * 1e5 / 3.1228, 1.17307e-9};
  const auto f = cable_frequencies(cable, 12, kInf);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_NEAR(f.in_hz[i] / f.out_hz[i], 1, 1e-9) << i;
}

}  // namespace
}  // namespace rigfit::ident::cable_frequencies_test
