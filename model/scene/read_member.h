// A [[member]] of a scene file, and keys that others share with it. Keys: apps/README.md.
#pragma once

#include "model/scene/scene_numbers.h"

namespace rigfit::model {

/// Throws SceneError naming file, line, key and remedy.
[[nodiscard]] Member read_member(TomlTable& table);

/// The key "name"; `fallback` where it is missing and the fallback is not empty.
[[nodiscard]] std::string name_in(TomlTable& table, const std::string& fallback);
/// The key "position" along a member, 0 to 1.
[[nodiscard]] double position_of(TomlTable& table);

// The short form for a line of many poles: members and their nodes copied along an offset.
//
//   [[repeat]]
//   members = ["pole", "span"]     # what is copied, with the nodes they end at
//   count = 9                      # copies besides the original: "pole-2" ... "pole-10"
//   offset = [50.0, 0.0, 0.0]      # m, from each to the next
//
// A copied node that falls on a node there is already becomes that node. Two nodes of the repeated
// part that meet so must have the same support; a node outside it wins (the line's last anchor).

/// Appends the copies to the scene. Throws SceneError at the table's keys.
void repeat(Scene& scene, TomlTable& table);

}  // namespace rigfit::model
