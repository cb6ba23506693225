// Scenes that the tests of motions share.
#pragma once

#include "model/scene/scene.h"

namespace rigfit::model::testing {

inline SceneNode node(const char* name, Eigen::Vector3d position,
                      Support::Kind kind = Support::Kind::free) {
  SceneNode result;
  result.name = name;
  result.position = position;
  result.support.kind = kind;
  return result;
}

inline Sensor sensor(const char* member, double position, Sensor::Quantity quantity,
                     Eigen::Vector3d direction = {0, 1, 0}) {
  Sensor result;
  result.name = "sensor";
  result.place.member = member;
  result.place.position = position;
  result.quantity = quantity;
  result.direction = direction;
  return result;
}

/// The paper's cable at 200 N with a 1 kg mass hung at the quarter span and cut.
inline Scene released_cable(int segments = 30, double mass = 1) {
  Scene scene;
  scene.title = "cable, 200 N, release";
  scene.nodes = {node("left", {0, 0, 0}, Support::Kind::pinned),
                 node("right", {2.4, 0, 0}, Support::Kind::pinned)};
  Member cable;
  cable.name = "cable";
  cable.nodes = {"left", "right"};
  cable.segments = segments;
  cable.mass_per_length = 0.16667;
  cable.EA = 221780;
  cable.EI = {0.5972, 0.5972};
  cable.tension = 200;
  scene.members = {cable};
  Load load;
  load.name = "string";
  load.kind = Load::Kind::release;
  load.place.member = "cable";
  load.place.position = 0.25;
  load.mass = mass;
  scene.loads = {load};
  scene.sensors = {sensor("cable", 0.5, Sensor::Quantity::displacement),
                   sensor("cable", 0.5, Sensor::Quantity::acceleration)};
  return scene;
}

/// A beam between two cables: clamped below, tip carries both, with a tip mass.
inline Scene beam_and_cables(int segments) {
  Scene scene;
  scene.title = "beam and two cables";
  scene.nodes = {node("foot", {0, 0, 0}, Support::Kind::clamped), node("tip", {0, 0.75, 0}),
                 node("left", {-1.2, 0.75, 0}, Support::Kind::pinned),
                 node("right", {1.2, 0.75, 0}, Support::Kind::pinned)};
  scene.nodes[1].mass = 0.02;
  Member beam;
  beam.name = "beam";
  beam.kind = Member::Kind::beam;
  beam.nodes = {"foot", "tip"};
  beam.segments = segments;
  beam.mass_per_length = 0.295;
  beam.EA = 5e6;
  beam.EI = {2.1, 2.1};
  beam.taper = 0.8;
  beam.masses = {{0.61, 0.015}};
  Member left = released_cable().members[0];
  left.name = "left cable";
  left.nodes = {"left", "tip"};
  left.segments = segments;
  left.tension = 100;
  Member right = left;
  right.name = "right cable";
  right.nodes = {"tip", "right"};
  scene.members = {beam, left, right};
  scene.sensors = {sensor("beam", 0.8, Sensor::Quantity::displacement, {1, 0, 0})};
  Load load;
  load.kind = Load::Kind::impact;
  load.place.member = "beam";
  load.place.position = 0.8;
  load.direction = {1, 0, 0};
  load.peak = 5;
  load.duration = 0.003;
  scene.loads = {load};
  return scene;
}

}  // namespace rigfit::model::testing
