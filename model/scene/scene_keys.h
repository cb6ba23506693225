// Keys that nodes, members, loads and sensors share.
#pragma once

#include <Eigen/Core>
#include <string>

#include "model/scene/toml_table.h"

namespace rigfit::model {

/// Three numbers of a key.
[[nodiscard]] Eigen::Vector3d vector3(TomlTable& table, const std::string& key,
                                      const std::string& unit);
/// The key "name"; `fallback` where it is missing and the fallback is not empty.
[[nodiscard]] std::string name_in(TomlTable& table, const std::string& fallback);
/// The key "position" along a member, 0 to 1.
[[nodiscard]] double position_of(TomlTable& table);

}  // namespace rigfit::model
