#include "signal/impact/frf_labels.h"

#include <cmath>
#include <cstddef>

namespace rigfit::signal {

int uff_direction(const std::array<double, 3>& direction) {
  const double length = std::hypot(direction[0], direction[1], direction[2]);
  for (int axis = 0; axis < 3; ++axis) {
    const double along = direction[static_cast<std::size_t>(axis)];
    if (length > 0 && std::abs(along) > 0.999 * length) return along > 0 ? axis + 1 : -axis - 1;
  }
  return 0;
}

FrfForm form_of(const Channel& response, const Channel& force) {
  if (force.unit != "N") return FrfForm::unknown;
  if (response.unit == "m/s^2") return FrfForm::accelerance;
  if (response.unit == "m/s") return FrfForm::mobility;
  if (response.unit == "m") return FrfForm::receptance;
  return FrfForm::unknown;
}

std::string ratio_of_units(const std::string& response, const std::string& force) {
  if (response.empty() && force.empty()) return "";
  const auto part = [](const std::string& unit) {
    if (unit.empty()) return std::string("?");
    return unit.find('/') == std::string::npos ? unit : "(" + unit + ")";
  };
  return part(response) + "/" + part(force);
}

}  // namespace rigfit::signal
