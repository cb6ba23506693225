// A beam whose foot has lost part of its flexural rigidity, by itself and with a cable to each side
// at its tip: the truth of studies of damage.
#pragma once

#include <limits>
#include <string>

#include "model/scene/scene.h"

namespace rigfit::reference {

struct DamagedRig {
  double loss = 0;     ///< of EI in the lowest 15 % of the beam
  bool cables = true;  ///< false: the bare beam
  double foot_Nm_rad = std::numeric_limits<double>::infinity();  ///< rotational spring of the foot
};

/// Members "base", "shaft", "left cable", "right cable"; nodes "foot", "zone", "tip". 0.75 m, 2.1 N
/// m2, 0.295 kg/m; cables of 1.195 m, 200 N.
inline model::Scene damaged_rig(const DamagedRig& rig) {
  constexpr double kEI = 2.1, kZone = 0.1125;
  model::Scene scene;
  const auto node = [&](const char* name, double x, double y, model::Support::Kind kind) {
    model::SceneNode one;
    one.name = name;
    one.position = {x, y, 0};
    one.support.kind = kind;
    scene.nodes.push_back(one);
  };
  using Kind = model::Support::Kind;
  node("foot", 0, -0.75, Kind::elastic);
  scene.nodes[0].support.translational.setConstant(std::numeric_limits<double>::infinity());
  scene.nodes[0].support.rotational = {std::numeric_limits<double>::infinity(),
                                       std::numeric_limits<double>::infinity(), rig.foot_Nm_rad};
  node("zone", 0, -0.75 + kZone, Kind::free);
  node("tip", 0, 0, Kind::free);
  scene.nodes[2].mass = 0.02;
  const auto member = [&](const char* name, const char* from, const char* to, bool cable, double EI,
                          int segments) {
    model::Member one;
    one.name = name;
    one.kind = cable ? model::Member::Kind::cable : model::Member::Kind::beam;
    one.nodes = {from, to};
    one.segments = segments;
    one.mass_per_length = cable ? 0.16667 : 0.295;
    one.EA = cable ? 221780 : 7.5e6;
    one.EI = {EI, cable ? EI : 260};
    one.GJ = cable ? 0.1 : 3.2;
    if (cable) one.tension = 200;
    scene.members.push_back(one);
  };
  member("base", "foot", "zone", false, kEI * (1 - rig.loss), 4);
  member("shaft", "zone", "tip", false, kEI, 16);
  if (rig.cables) {
    node("left frame", -1.195, 0, Kind::pinned);
    node("right frame", 1.195, 0, Kind::pinned);
    member("left cable", "left frame", "tip", true, 0.5972, 14);
    member("right cable", "tip", "right frame", true, 0.5972, 14);
  }
  return scene;
}

}  // namespace rigfit::reference
