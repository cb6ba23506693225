// The paper's rig, built in memory: what the model's tests share.
#pragma once

#include "model/scene/scene.h"

namespace rigfit::model::testing {

/// The paper's cable: 2.4 m, pinned, level, 0.16667 kg/m, EA 221.78 kN.
inline Scene paper_cable(double tension, double EI, int segments = 30) {
  Scene scene;
  scene.title = "cable";
  SceneNode left, right;
  left.name = "left";
  right.name = "right";
  right.position << 2.4, 0, 0;
  left.support.kind = right.support.kind = Support::Kind::pinned;
  scene.nodes = {left, right};
  Member cable;
  cable.name = "cable";
  cable.kind = Member::Kind::cable;
  cable.nodes = {"left", "right"};
  cable.segments = segments;
  cable.mass_per_length = 0.16667;
  cable.EA = 221780;
  cable.EI = {EI, EI};
  cable.GJ = 0.1;
  cable.tension = tension;
  scene.members = {cable};
  return scene;
}

/// A vertical cantilever of `length` m, stress-free as drawn.
inline Scene vertical_beam(double length, double EI, double mass_per_length, int segments = 30) {
  Scene scene;
  scene.title = "beam";
  SceneNode base, tip;
  base.name = "base";
  base.support.kind = Support::Kind::clamped;
  tip.name = "tip";
  tip.position << 0, length, 0;
  scene.nodes = {base, tip};
  Member beam;
  beam.name = "beam";
  beam.kind = Member::Kind::beam;
  beam.nodes = {"base", "tip"};
  beam.segments = segments;
  beam.mass_per_length = mass_per_length;
  beam.EA = 1e7;
  beam.EI = {EI, EI};
  beam.GJ = EI;
  scene.members = {beam};
  return scene;
}

/// The paper's cable-beam rig with the values inferred from its tables; the beam's flexural
/// rigidity out of the plane is a guess.
inline Scene cable_beam_rig(double tension, double cable_EI, int segments = 30) {
  Scene scene = vertical_beam(0.75, 2.1, 0.295, segments);
  scene.title = "rig";
  scene.members[0].EI = {2.1, 20};
  scene.members[0].GJ = 2;
  scene.nodes[1].mass = 0.02;
  for (int side : {-1, 1}) {
    SceneNode end;
    end.name = side < 0 ? "left" : "right";
    end.position << side * 1.2, 0.75, 0;
    end.support.kind = Support::Kind::pinned;
    scene.nodes.push_back(end);
    Member cable = paper_cable(tension, cable_EI, segments).members[0];
    cable.name = side < 0 ? "left cable" : "right cable";
    cable.nodes = {side < 0 ? "left" : "tip", side < 0 ? "tip" : "right"};
    scene.members.push_back(cable);
  }
  return scene;
}

}  // namespace rigfit::model::testing
