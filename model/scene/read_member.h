// A [[member]] of a scene file, and keys that others share with it. Keys: apps/README.md.
#pragma once

#include <string>

#include "model/scene/scene.h"
#include "model/scene/toml_table.h"

namespace rigfit::model {

/// Throws SceneError naming file, line, key and remedy.
[[nodiscard]] Member read_member(TomlTable& table);

/// The key "name"; `fallback` where it is missing and the fallback is not empty.
[[nodiscard]] std::string name_in(TomlTable& table, const std::string& fallback);
/// The key "position" along a member, 0 to 1.
[[nodiscard]] double position_of(TomlTable& table);

}  // namespace rigfit::model
