#include "ident/predict/damage_estimate.h"

#include "ident/update/model_update.h"
#include "tests/reference/damage_study.h"
#include "tests/test.h"

namespace rigfit::ident::damage_estimate_test {

FittedParameters fit(double zone, double sound, double zone_std, double sound_std,
                     double correlation) {
  FittedParameters fitted{
      .parameters = {{"base.EI", zone}, {"shaft.EI", sound}, {"ground.rotational_z", 1}}};
  fitted.covariance.setZero(3, 3);
  fitted.covariance(0, 0) = zone_std * zone_std;
  fitted.covariance(1, 1) = sound_std * sound_std;
  fitted.covariance(2, 2) = 1;
  fitted.covariance(0, 1) = fitted.covariance(1, 0) = correlation * zone_std * sound_std;
  return fitted;
}

TEST(DamageEstimate, IsTheLossWithItsUncertainty) {
  // d = 1 - 7 / 10, var ln ratio = 0.02^2 + 0.01^2 - 2 * 0.5 * 0.02 * 0.01 = 3e-4.
  const auto one = damage_estimate(fit(7, 10, 0.14, 0.1, 0.5), {"base.EI", "shaft.EI", {}, 1});
  EXPECT_NEAR(one.damage.value, 0.3, 1e-12);
  EXPECT_NEAR(one.damage.std, 0.7 * std::sqrt(3e-4), 1e-12);
  EXPECT_TRUE(one.called);
  EXPECT_NEAR(one.smallest_found, 2 * 1.6448536269514722 * one.damage.std, 1e-12);
  EXPECT_TRUE(one.like.empty());
  EXPECT_THROW((void)damage_estimate(fit(7, 10, 1, 1, 0), {"base.GJ", "", {10, 0}, 1}),
               std::invalid_argument);
}

TEST(DamageEstimate, SaysWhenSoilAndDamageCannotBeToldApart) {
  auto fitted = fit(7, 10, 2, 0, 0);
  fitted.covariance(0, 2) = fitted.covariance(2, 0) = -0.99 * 2;
  const auto one = damage_estimate(fitted, {"base.EI", "", {10, 0}, 1});
  ASSERT_EQ(one.like.size(), 1u);
  EXPECT_THAT(one.statement, HasSubstr("ground.rotational_z"));
  EXPECT_FALSE(one.called);
}

// 30 % of EI lost in the lowest 15 % of the beam, eight coupled frequencies to 0.1 %: the bare beam
// is seen through its cables. The whole study: pole_damage in tests/bench.
TEST(PoleDamage, IsFoundThroughTheCables) {
  const double bare = reference::first_in_plane_hz({0.3, false});
  EXPECT_NEAR(bare / reference::first_in_plane_hz({0, false}) - 1, -0.095, 0.005);
  int inside = 0;
  for (int seed = 1; seed <= 4; ++seed) {
    const auto outcome = reference::damage_outcome({}, static_cast<std::uint64_t>(seed));
    ASSERT_TRUE(outcome.converged) << seed;
    EXPECT_TRUE(outcome.damage.called) << seed;
    EXPECT_NEAR(outcome.bare_hz / bare, 1, 3e-3) << seed;
    inside += std::abs(outcome.damage.damage.value - 0.3) <= 2.5 * outcome.damage.damage.std;
  }
  EXPECT_GE(inside, 3);  // 1 % outside of 2.5 std each: two of four with 6e-4
}

}  // namespace rigfit::ident::damage_estimate_test
