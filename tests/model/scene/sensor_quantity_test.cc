#include "model/scene/sensor_quantity.h"

#include <gtest/gtest.h>

#include <set>

#include "model/scene/scene_error.h"

namespace rigfit::model::sensor_quantity_test {
namespace {

TEST(SensorQuantity, EveryOneIsListedOnceAndFoundByName) {
  std::set<Sensor::Quantity> seen;
  for (const SensorQuantity& one : sensor_quantities()) {
    EXPECT_TRUE(seen.insert(one.quantity).second) << one.name;
    EXPECT_EQ(&described(one.quantity), &one);
    EXPECT_EQ(sensor_quantity_named(one.name), one.quantity);
  }
  for (const auto quantity : {Sensor::Quantity::acceleration, Sensor::Quantity::velocity,
                              Sensor::Quantity::displacement, Sensor::Quantity::force}) {
    EXPECT_TRUE(seen.count(quantity));
  }
  EXPECT_EQ(sensor_quantity_names().size(), seen.size());
  EXPECT_EQ(sensor_quantities().front().quantity, Sensor{}.quantity);
  EXPECT_THROW(static_cast<void>(sensor_quantity_named("jerk")), SceneError);
}

TEST(SensorQuantity, UnitsFollowFromTheReadingAndItsDerivatives) {
  const char* of_displacement[] = {"m", "m/s", "m/s^2"};
  for (const SensorQuantity& one : sensor_quantities()) {
    if (one.reading == SensorReading::displacement) {
      EXPECT_STREQ(one.unit, of_displacement[one.derivatives]) << one.name;
    } else {
      EXPECT_STREQ(one.unit, "N") << one.name;
    }
  }
}

}  // namespace
}  // namespace rigfit::model::sensor_quantity_test
