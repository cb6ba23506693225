// A [[member]] of a scene file. Keys: apps/README.md.
#pragma once

#include "model/scene/scene.h"
#include "model/scene/toml_table.h"

namespace rigfit::model {

/// Throws SceneError naming file, line, key and remedy.
[[nodiscard]] Member read_member(TomlTable& table);

}  // namespace rigfit::model
