// The physical quantity that a channel, a unit or a sensor stands for.
#pragma once

namespace rigfit::signal {

enum class Quantity {
  unknown,
  time,
  force,
  acceleration,
  velocity,
  displacement,
  angle,
  angular_velocity,
  angular_acceleration,
  torque,
  strain,
  pressure,
  temperature,
  voltage,
};

/// The word used in JSON and messages, such as "acceleration".
[[nodiscard]] const char* name_of(Quantity quantity);
/// Its SI symbol, such as "m/s^2"; empty for `unknown`.
[[nodiscard]] const char* si_of(Quantity quantity);

}  // namespace rigfit::signal
