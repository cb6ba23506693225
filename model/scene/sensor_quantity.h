// Table of the quantities that sensors can read: for each its name in scene files, its unit, the
// number of time derivatives and the part of the motion that it reads.
//
// A quantity is linear in the motion: y = (d/dt)^n r q, with a row r. To add one, add its
// enumerator to Sensor::Quantity, its line below and a test. If it reads another part of the
// motion, add also its row to `sensor_rows` (model/linear/modes.cc) and its value to `sample` of
// both schemes (model/motion).
#pragma once

#include "model/scene/scene.h"

namespace rigfit::model {

/// Part of the motion that a quantity reads, before differentiation.
enum class SensorReading {
  displacement,  ///< displacement of a point from the equilibrium along the sensor's direction, m
  axial_force,   ///< axial force in a member's segment, static part included, N
};

/// One quantity.
struct SensorQuantity {
  Sensor::Quantity quantity;
  const char* name;  ///< in scene files and JSON
  const char* unit;  ///< SI
  SensorReading reading;
  int derivatives;  ///< number of time derivatives of the reading
};

/// All quantities, in the order of their enumerators; the first is the default of a scene file.
inline constexpr std::array<SensorQuantity, 4> kSensorQuantities{{
    {Sensor::Quantity::acceleration, "acceleration", "m/s^2", SensorReading::displacement, 2},
    {Sensor::Quantity::velocity, "velocity", "m/s", SensorReading::displacement, 1},
    {Sensor::Quantity::displacement, "displacement", "m", SensorReading::displacement, 0},
    {Sensor::Quantity::force, "force", "N", SensorReading::axial_force, 0},
}};
/// The entry of one quantity.
[[nodiscard]] constexpr const SensorQuantity& described(Sensor::Quantity quantity) {
  return kSensorQuantities[static_cast<std::size_t>(quantity)];
}

}  // namespace rigfit::model
