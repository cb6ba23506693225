#include <gtest/gtest.h>

#include <cmath>

#include "tests/reference/damage_study.h"

namespace rigfit::reference::pole_damage_test {
namespace {

// 30 % of EI lost in the lowest 15 % of the beam, eight coupled frequencies to 0.1 %: the bare beam
// is seen through its cables. The whole study: pole_damage in tests/bench.
TEST(PoleDamage, IsFoundThroughTheCables) {
  const double bare = first_in_plane_hz({0.3, false});
  EXPECT_NEAR(bare / first_in_plane_hz({0, false}) - 1, -0.095, 0.005);
  int inside = 0;
  for (int seed = 1; seed <= 4; ++seed) {
    const auto outcome = damage_outcome({}, static_cast<std::uint64_t>(seed));
    ASSERT_TRUE(outcome.converged) << seed;
    EXPECT_TRUE(outcome.damage.called) << seed;
    EXPECT_NEAR(outcome.bare_hz / bare, 1, 3e-3) << seed;
    inside += std::abs(outcome.damage.damage.value - 0.3) <= 2.5 * outcome.damage.damage.std;
  }
  EXPECT_GE(inside, 3);  // 1 % outside of 2.5 std each: two of four with 6e-4
}

}  // namespace
}  // namespace rigfit::reference::pole_damage_test
