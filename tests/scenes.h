// Scenes that tests and benchmarks share, built in memory.
#pragma once

#include <string>
#include <utility>

#include "model/scene/scene.h"

namespace rigfit::model::testing {

inline SceneNode node(std::string name, const Eigen::Vector3d& position,
                      Support::Kind kind = Support::Kind::free) {
  SceneNode result{.name = std::move(name), .position = position, .support = {.kind = kind}};
  return result;
}

/// Without torsion; its EI is that of both planes.
inline Member member(Member::Kind kind, std::string name, std::string from, std::string to,
                     int segments, double mass_per_length, double EA, double EI) {
  Member result;
  result.name = std::move(name);
  result.kind = kind;
  result.nodes = {std::move(from), std::move(to)};
  result.segments = segments;
  result.mass_per_length = mass_per_length;
  result.EA = EA;
  result.EI = {EI, EI};
  return result;
}

/// One member between two nodes.
inline Scene span(Member member, SceneNode first, SceneNode second) {
  Scene scene;
  member.nodes = {first.name, second.name};
  scene.nodes = {std::move(first), std::move(second)};
  scene.members = {std::move(member)};
  return scene;
}

inline Sensor sensor(const char* member, double position, Sensor::Quantity quantity,
                     const Eigen::Vector3d& direction = {0, 1, 0}) {
  return {"sensor", {"", member, position}, direction, quantity};
}

/// A half sine.
inline Load impact(Place place, const Eigen::Vector3d& direction, double peak, double duration,
                   std::string name = "hammer") {
  Load load{.name = std::move(name),
            .place = std::move(place),
            .direction = direction,
            .peak = peak,
            .duration = duration};
  return load;
}

/// The paper's cable: 2.4 m, pinned, level, 0.16667 kg/m, EA 221.78 kN.
inline Scene paper_cable(double tension, double EI, int segments = 30) {
  Member cable = member(Member::Kind::cable, "cable", "", "", segments, 0.16667, 221780, EI);
  cable.GJ = 0.1;
  cable.tension = tension;
  Scene scene = span(cable, node("left", {0, 0, 0}, Support::Kind::pinned),
                     node("right", {2.4, 0, 0}, Support::Kind::pinned));
  scene.title = "cable";
  return scene;
}

/// A vertical cantilever of `length` m, stress-free as drawn.
inline Scene vertical_beam(double length, double EI, double mass_per_length, int segments = 30) {
  Member beam = member(Member::Kind::beam, "beam", "", "", segments, mass_per_length, 1e7, EI);
  beam.GJ = EI;
  Scene scene =
      span(beam, node("base", {0, 0, 0}, Support::Kind::clamped), node("tip", {0, length, 0}));
  scene.title = "beam";
  return scene;
}

/// A weightless level cantilever of 1 m along x, from "foot" to "tip".
inline Scene level_cantilever(double EI, double mass_per_length, int segments) {
  Member beam = member(Member::Kind::beam, "beam", "", "", segments, mass_per_length, 1e7, EI);
  beam.GJ = EI;
  Scene scene = span(beam, node("foot", {0, 0, 0}, Support::Kind::clamped), node("tip", {1, 0, 0}));
  scene.gravity.setZero();
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
  for (const bool left : {true, false}) {
    const char* end = left ? "left" : "right";
    scene.nodes.push_back(node(end, {left ? -1.2 : 1.2, 0.75, 0}, Support::Kind::pinned));
    Member cable = paper_cable(tension, cable_EI, segments).members[0];
    cable.name = end + std::string(" cable");
    cable.nodes = {left ? "left" : "tip", left ? "tip" : "right"};
    scene.members.push_back(cable);
  }
  return scene;
}

/// The paper's cable at 200 N, without torsion, with a 1 kg mass hung at the quarter span and cut.
inline Scene released_cable(int segments = 30, double mass = 1) {
  Scene scene = paper_cable(200, 0.5972, segments);
  scene.title = "cable, 200 N, release";
  scene.members[0].GJ = 0;
  Load load{
      .name = "string", .kind = Load::Kind::release, .place = {"", "cable", 0.25}, .mass = mass};
  scene.loads = {load};
  scene.sensors = {sensor("cable", 0.5, Sensor::Quantity::displacement),
                   sensor("cable", 0.5, Sensor::Quantity::acceleration)};
  return scene;
}

/// A beam between two cables: clamped below, its tip carries both and a mass.
inline Scene beam_and_cables(int segments) {
  Scene scene{.title = "beam and two cables"};
  scene.nodes = {node("foot", {0, 0, 0}, Support::Kind::clamped), node("tip", {0, 0.75, 0}),
                 node("left", {-1.2, 0.75, 0}, Support::Kind::pinned),
                 node("right", {1.2, 0.75, 0}, Support::Kind::pinned)};
  scene.nodes[1].mass = 0.02;
  Member beam = member(Member::Kind::beam, "beam", "foot", "tip", segments, 0.295, 5e6, 2.1);
  beam.taper = 0.8;
  beam.masses = {{0.61, 0.015}};
  Member left = released_cable(segments).members[0];
  left.name = "left cable";
  left.nodes = {"left", "tip"};
  left.tension = 100;
  Member right = left;
  right.name = "right cable";
  right.nodes = {"tip", "right"};
  scene.members = {beam, left, right};
  scene.sensors = {sensor("beam", 0.8, Sensor::Quantity::displacement, {1, 0, 0})};
  scene.loads = {impact({"", "beam", 0.8}, {1, 0, 0}, 5, 0.003)};
  return scene;
}

/// A line of poles: conductors of 40 m between the tops of 8 m tapered poles.
inline Scene utility_line(int poles, int cable_segments = 40, int pole_segments = 12) {
  Scene scene{.title = "line of " + std::to_string(poles) + " poles"};
  for (int k = 0; k <= poles + 1; ++k) {
    const std::string number = std::to_string(k);
    const bool pole = k > 0 && k <= poles;
    if (pole) {
      scene.nodes.push_back(node("foot " + number, {40.0 * k, 0, 0}, Support::Kind::clamped));
    }
    scene.nodes.push_back(node("top " + number, {40.0 * k, 8, 0},
                               pole ? Support::Kind::free : Support::Kind::pinned));
    if (pole) scene.nodes.back().mass = 3;
  }
  for (int k = 0; k <= poles; ++k) {
    const std::string number = std::to_string(k), top = "top " + number;
    Member cable = member(Member::Kind::cable, "conductor " + number, top,
                          "top " + std::to_string(k + 1), cable_segments, 0.5, 7e6, 30);
    cable.tension = 3000;
    scene.members.push_back(cable);
    if (k == 0) continue;
    Member pole = member(Member::Kind::beam, "pole " + number, "foot " + number, top, pole_segments,
                         30, 5e8, 1.5e6);
    pole.GJ = 1e5;
    pole.taper = 0.7;
    scene.members.push_back(pole);
  }
  return scene;
}

}  // namespace rigfit::model::testing
