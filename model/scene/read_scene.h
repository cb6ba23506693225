// Scene files (TOML) in and out. Every key is checked: unknown keys, wrong types, missing nodes,
// negative or non-finite values are refused with file, line, key and remedy.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "model/scene/scene.h"

namespace rigfit::model {

/// Throws SceneError.
[[nodiscard]] Scene read_scene(const std::filesystem::path& path);
/// The same from text; `file` is named in messages.
[[nodiscard]] Scene parse_scene(std::string_view text, const std::string& file);
/// A scene file that reads back to the same scene.
[[nodiscard]] std::string scene_text(const Scene& scene);

}  // namespace rigfit::model
