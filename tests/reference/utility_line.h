// A line of poles: conductors of 40 m between the tops of 8 m tapered poles.
#pragma once

#include <string>

#include "model/scene/scene.h"

namespace rigfit::apps {

inline model::Scene utility_line(int poles, int cable_segments = 40, int pole_segments = 12) {
  model::Scene scene;
  scene.title = "line of " + std::to_string(poles) + " poles";
  const double span = 40, height = 8;
  for (int k = 0; k <= poles + 1; ++k) {
    model::SceneNode top;
    top.name = "top " + std::to_string(k);
    top.position << k * span, height, 0;
    if (k == 0 || k == poles + 1) {
      top.support.kind = model::Support::Kind::pinned;
    } else {
      top.mass = 3;
      model::SceneNode foot;
      foot.name = "foot " + std::to_string(k);
      foot.position << k * span, 0, 0;
      foot.support.kind = model::Support::Kind::clamped;
      scene.nodes.push_back(foot);
    }
    scene.nodes.push_back(top);
  }
  for (int k = 0; k <= poles; ++k) {
    model::Member cable;
    cable.name = "conductor " + std::to_string(k);
    cable.nodes = {"top " + std::to_string(k), "top " + std::to_string(k + 1)};
    cable.segments = cable_segments;
    cable.mass_per_length = 0.5;
    cable.EA = 7e6;
    cable.EI = {30, 30};
    cable.tension = 3000;
    scene.members.push_back(cable);
    if (k == 0) continue;
    model::Member pole;
    pole.name = "pole " + std::to_string(k);
    pole.kind = model::Member::Kind::beam;
    pole.nodes = {"foot " + std::to_string(k), "top " + std::to_string(k)};
    pole.segments = pole_segments;
    pole.mass_per_length = 30;
    pole.EA = 5e8;
    pole.EI = {1.5e6, 1.5e6};
    pole.GJ = 1e5;
    pole.taper = 0.7;
    scene.members.push_back(pole);
  }
  return scene;
}

}  // namespace rigfit::apps
