#include "apps/bench/bench_scenes.h"

#include <string>

#include "apps/cli/assets.h"
#include "model/scene/read_scene.h"

namespace rigfit::apps {

model::Scene bench_cable() {
  model::Scene scene = model::parse_scene(assets::new_cable_toml, "cable.toml");
  scene.members[0].segments = 30;
  scene.sensors[0].quantity = model::Sensor::Quantity::displacement;
  return scene;
}

model::Scene bench_released_cable() {
  model::Scene scene = bench_cable();
  scene.title += ", 1 kg released at the quarter span";
  model::Load release;
  release.name = "string";
  release.kind = model::Load::Kind::release;
  release.place.member = scene.members[0].name;
  release.place.position = 0.25;
  release.mass = 1;
  scene.loads = {release};
  return scene;
}

model::Scene bench_rig() {
  model::Scene scene = model::parse_scene(assets::rig_toml, "rig.toml");
  for (auto& member : scene.members) member.segments = 30;
  return scene;
}

}  // namespace rigfit::apps
