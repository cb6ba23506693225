#include "model/scene/scene_keys.h"

#include <fmt/format.h>

namespace rigfit::model {

Eigen::Vector3d vector3(TomlTable& table, const std::string& key, const std::string& unit) {
  const auto v = table.numbers(key, 3, 3, Bound::any, unit);
  return {v[0], v[1], v[2]};
}

std::string name_in(TomlTable& table, const std::string& fallback) {
  if (!table.has("name") && !fallback.empty()) return fallback;
  std::string name = table.string("name");
  if (name.empty()) throw table.error("name", "is empty", "give each one a name of its own");
  return name;
}

double position_of(TomlTable& table) {
  const double position = table.number("position", Bound::any, "");
  if (position < 0 || position > 1) {
    throw table.error("position", fmt::format("must be from 0 to 1, got {}", position),
                      "give the fraction of the member's length from its first node");
  }
  return position;
}

}  // namespace rigfit::model
