// A taut hanger with ends of a kind, and its modes as measured ones.
#pragma once

#include <limits>
#include <vector>

#include "model/scene/scene.h"
#include "tests/ident/update/fit_data.h"

namespace rigfit::ident::testing {

constexpr double kLength = 10, kTension = 5e5;  // m, N

// A hanger of 30 kg/m; springs of `rotational` N m/rad where the support is elastic.
inline model::Scene hanger(model::Support::Kind kind, double EI, double rotational = 0) {
  model::Scene scene;
  scene.gravity.setZero();
  constexpr double kFixed = std::numeric_limits<double>::infinity();
  for (const double x : {0.0, kLength}) {
    model::SceneNode node;
    node.name = x == 0 ? "a" : "b";
    node.position = {x, 0, 0};
    node.support.kind = kind;
    if (kind == model::Support::Kind::elastic) {
      node.support.translational.setConstant(kFixed);
      node.support.rotational = {kFixed, rotational, rotational};
    }
    scene.nodes.push_back(node);
  }
  model::Member member;
  member.name = "h";
  member.kind = model::Member::Kind::cable;
  member.nodes = {"a", "b"};
  member.segments = 40;
  member.mass_per_length = 30;
  member.EA = 2e3 * kTension;
  member.EI = {EI, EI};
  member.GJ = EI;
  member.tension = kTension;
  scene.members.push_back(member);
  return scene;
}

// Its first modes in the plane, each known to a relative `std`.
inline std::vector<MeasuredMode> measured(const model::Scene& truth, std::size_t count,
                                          double std) {
  return modes_of(truth, model::ModePlane::in, count, std);
}

}  // namespace rigfit::ident::testing
