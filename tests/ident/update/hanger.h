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
  namespace build = model::testing;
  auto member = build::member(model::Member::Kind::cable, "h", "", "", 40, 30, 2e3 * kTension, EI);
  member.GJ = EI;
  member.tension = kTension;
  auto scene = build::span(member, build::node("a", {0, 0, 0}, kind),
                           build::node("b", {kLength, 0, 0}, kind));
  scene.gravity.setZero();
  constexpr double kFixed = std::numeric_limits<double>::infinity();
  for (auto& node : scene.nodes) {
    if (kind != model::Support::Kind::elastic) continue;
    node.support.translational.setConstant(kFixed);
    node.support.rotational = {kFixed, rotational, rotational};
  }
  return scene;
}

// Its first modes in the plane, each known to a relative `std`.
inline std::vector<MeasuredMode> measured(const model::Scene& truth, std::size_t count,
                                          double std) {
  return modes_of(truth, model::ModePlane::in, count, std);
}

}  // namespace rigfit::ident::testing
