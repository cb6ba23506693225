#include "model/scene/sensor_quantity.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "model/scene/scene_error.h"

namespace rigfit::model {
namespace {

constexpr std::array<SensorQuantity, 4> kQuantities{{
    {Sensor::Quantity::acceleration, "acceleration", "m/s^2", SensorReading::displacement, 2},
    {Sensor::Quantity::velocity, "velocity", "m/s", SensorReading::displacement, 1},
    {Sensor::Quantity::displacement, "displacement", "m", SensorReading::displacement, 0},
    {Sensor::Quantity::force, "force", "N", SensorReading::axial_force, 0},
}};

}  // namespace

std::span<const SensorQuantity> sensor_quantities() { return kQuantities; }

const SensorQuantity& described(Sensor::Quantity quantity) {
  const auto at = std::find_if(kQuantities.begin(), kQuantities.end(),
                               [&](const auto& one) { return one.quantity == quantity; });
  assert(at != kQuantities.end());
  return *at;
}

std::vector<std::string> sensor_quantity_names() {
  std::vector<std::string> names;
  for (const auto& one : kQuantities) names.emplace_back(one.name);
  return names;
}

Sensor::Quantity sensor_quantity_named(const std::string& name) {
  for (const auto& one : kQuantities) {
    if (name == one.name) return one.quantity;
  }
  throw SceneError({}, "\"" + name + "\" is no quantity of a sensor", "see sensor_quantity.h");
}

}  // namespace rigfit::model
