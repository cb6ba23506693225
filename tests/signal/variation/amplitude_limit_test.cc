#include "signal/variation/amplitude_limit.h"

#include <gtest/gtest.h>

#include <complex>
#include <random>

namespace rigfit::signal::amplitude_limit_test {
namespace {
using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::VectorXcd;

/// One response, 60 lines, five hits of impulse 0.7 to 1.3: a resonance of which `share` at its
/// peak goes with the squared impulse, noise of 0.01 % of the peak, and a factor that is random
/// from hit to hit.
FrfSet set_of_hits(double share, double random_share, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.7, 1.3);
  FrfSet set;
  set.frequency_hz = Eigen::VectorXd::LinSpaced(60, 1, 60);
  set.responses.resize(1);
  set.inputs.resize(1);
  set.hit_impulse.resize(1);
  const VectorXcd s = Complex(0, 1) * set.frequency_hz.cast<Complex>();
  const VectorXcd mode = (s.array() - Complex(-1, 30)).inverse();
  const VectorXcd change = (s.array() - Complex(-3, 30)).inverse();
  for (int hit = 0; hit < 5; ++hit) {
    const double impulse = uniform(random);
    const double size = share * impulse * impulse + random_share * normal(random);
    VectorXcd H = mode + Complex(0, size) * (change - mode);
    for (Complex& value : H) value += 1e-4 * Complex(normal(random), normal(random));
    set.hit_impulse[0].push_back(impulse);
    set.by_hit.emplace_back(H);
  }
  return set;
}

int certain_of_100(double share, double random_share) {
  int certain = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    certain += chance_of_size_dependence(set_of_hits(share, random_share, seed), 1, 60) < 0.01;
  }
  return certain;
}

// Noise alone, and hits that differ at random, all lines together: 1 of 100 is expected, 6 or more
// in one of 2000 cases.
TEST(AmplitudeLimit, FrfsThatDoNotGoWithTheSizeOfHitsAreNotTakenForSuch) {
  EXPECT_LT(certain_of_100(0, 0), 6);
  EXPECT_LT(certain_of_100(0, 0.05), 6);
}

// Squared impulses of 0.35 std move some two lines at the peak by 0.05 * 0.35 * 2 / 3 each: five
// hits give 1.4e-3 of power, noise of 60 lines 1.2e-6 a degree of freedom; F of some 1000, where 34
// is one chance in a hundred.
TEST(AmplitudeLimit, FrfsThatGoWithTheSizeOfHitsAreFound) {
  EXPECT_GT(certain_of_100(0.05, 0), 90);
}

TEST(AmplitudeLimit, TellsNothingWithoutHitsOfDifferentSize) {
  FrfSet set = set_of_hits(0.05, 0, 1);
  set.hit_impulse[0].assign(5, 1.0);
  EXPECT_EQ(chance_of_size_dependence(set, 1, 60), 1);
  set.hit_impulse.clear();
  EXPECT_EQ(chance_of_size_dependence(set, 1, 60), 1);
  EXPECT_EQ(chance_of_size_dependence(set_of_hits(0.05, 0, 1), 70, 80), 1);
  EXPECT_EQ(chance_of_size_dependence({}, 1, 60), 1);
}

}  // namespace
}  // namespace rigfit::signal::amplitude_limit_test
