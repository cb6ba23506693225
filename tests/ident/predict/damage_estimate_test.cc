#include "ident/predict/damage_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "ident/update/model_update.h"

namespace rigfit::ident::damage_estimate_test {
namespace {

FittedParameters fit(double zone, double sound, double zone_std, double sound_std,
                     double correlation) {
  FittedParameters fitted;
  fitted.parameters = {{"base.EI", zone}, {"shaft.EI", sound}, {"ground.rotational_z", 1}};
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
  EXPECT_NEAR(one.smallest_found, 2 * 1.644854 * one.damage.std, 1e-12);
  EXPECT_TRUE(one.like.empty());
  EXPECT_THROW((void)damage_estimate(fit(7, 10, 1, 1, 0), {"base.GJ", "", {10, 0}, 1}),
               std::invalid_argument);
}

TEST(DamageEstimate, SaysWhenSoilAndDamageCannotBeToldApart) {
  auto fitted = fit(7, 10, 2, 0, 0);
  fitted.covariance(0, 2) = fitted.covariance(2, 0) = -0.99 * 2;
  const auto one = damage_estimate(fitted, {"base.EI", "", {10, 0}, 1});
  ASSERT_EQ(one.like.size(), 1u);
  EXPECT_NE(one.statement.find("ground.rotational_z"), std::string::npos);
  EXPECT_FALSE(one.called);
}

}  // namespace
}  // namespace rigfit::ident::damage_estimate_test
