// Table of the quantities that sensors can read: for each its name in scene files, its unit, the
// number of time derivatives and the part of the motion that it reads.
//
// A quantity is linear in the motion: y = (d/dt)^n r q, with a row r. To add one, add its
// enumerator to Sensor::Quantity, its line to sensor_quantity.cc and a test. If it reads
// another part of the motion, add also its row to `sensor_rows` (model/linear/modes.cc) and its
// value to MotionKernel::sensor_value (model/motion).
#pragma once

#include <span>
#include <string>
#include <vector>

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

/// All quantities; the first is the default of a scene file.
[[nodiscard]] std::span<const SensorQuantity> sensor_quantities();
/// The entry of one quantity.
[[nodiscard]] const SensorQuantity& described(Sensor::Quantity quantity);
/// Their names, in order.
[[nodiscard]] std::vector<std::string> sensor_quantity_names();
/// The quantity of a name; throws SceneError for one that does not exist.
[[nodiscard]] Sensor::Quantity sensor_quantity_named(const std::string& name);

}  // namespace rigfit::model
