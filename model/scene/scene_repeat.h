// The short form for a line of many poles: members and their nodes copied along an offset.
//
//   [[repeat]]
//   members = ["pole", "span"]     # what is copied, with the nodes they end at
//   count = 9                      # copies besides the original: "pole-2" ... "pole-10"
//   offset = [50.0, 0.0, 0.0]      # m, from each to the next
//
// A copied node that falls on a node there is already becomes that node. Two nodes of the repeated
// part that meet so must have the same support; a node outside it wins (the line's last anchor).
#pragma once

#include "model/scene/scene.h"
#include "model/scene/toml_table.h"

namespace rigfit::model {

/// Appends the copies to the scene. Throws SceneError at the table's keys.
void repeat(Scene& scene, TomlTable& table);

}  // namespace rigfit::model
