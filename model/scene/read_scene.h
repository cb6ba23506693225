// Reads and writes scene files (TOML). Every key is checked: unknown keys, wrong types, missing
// nodes, negative or non-finite values are refused with file, line, key and remedy.
#pragma once

#include <filesystem>
#include <string_view>

#include "model/scene/scene.h"

namespace rigfit::model {

/// Reads a file. Throws SceneError.
[[nodiscard]] Scene read_scene(const std::filesystem::path& path);
/// Reads a scene from text; messages name `file`. Throws SceneError.
[[nodiscard]] Scene parse_scene(std::string_view text, const std::string& file);
/// Text of a scene file that is read back as the same scene.
[[nodiscard]] std::string scene_text(const Scene& scene);

}  // namespace rigfit::model
