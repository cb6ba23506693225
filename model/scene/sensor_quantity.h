// What sensors can read: the one place that says of each quantity its word in scene files, its
// unit, how often the motion is differentiated for it, and what of the motion it reads.
//
// A quantity is linear in the motion: y = (d/dt)^n r q with the row r of what it reads. To add one:
// its enumerator in Sensor::Quantity, its line in sensor_quantity.cc and a test; if it reads
// something new of the motion, also its row in `sensor_row` (model/linear/modes.cc) and its value
// in MotionKernel::sensor_value (model/motion).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "model/scene/scene.h"

namespace rigfit::model {

/// What a quantity reads, before it is differentiated.
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
  int derivatives;  ///< by time, of the reading
};

/// All there are; the first is the default of a scene file.
[[nodiscard]] std::span<const SensorQuantity> sensor_quantities();
/// The entry of one quantity.
[[nodiscard]] const SensorQuantity& described(Sensor::Quantity quantity);
/// Their names, in order.
[[nodiscard]] std::vector<std::string> sensor_quantity_names();
/// The quantity of a name; throws SceneError for one that does not exist.
[[nodiscard]] Sensor::Quantity sensor_quantity_named(const std::string& name);

}  // namespace rigfit::model
