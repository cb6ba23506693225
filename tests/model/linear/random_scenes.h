// Scenes drawn at random, their segments left to the program.
#pragma once

#include <cmath>
#include <random>

#include "tests/scenes.h"

namespace rigfit::model::testing {

/// Pinned cables (kind 0), clamped ones, cables with a mass at a node of every chain, or anywhere,
/// standing beams with a tip mass, rigs of three members (5).
inline Scene random_scene(int kind, unsigned seed) {
  std::mt19937 generator(seed);
  const auto even = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(generator);
  };
  const auto log = [&](double low, double high) {
    return std::exp(even(std::log(low), std::log(high)));
  };
  if (kind == 5) {
    Scene scene = cable_beam_rig(log(50, 500), log(0.1, 2), 0);
    scene.nodes[1].mass = even(0, 0.1);
    return scene;
  }
  if (kind == 4) {
    Scene scene = vertical_beam(even(0.3, 1), log(1, 10), log(0.1, 1), 0);
    scene.nodes[1].mass = even(0, 0.1);
    return scene;
  }
  Scene scene = paper_cable(log(20, 2000), log(0.05, 5), 0);
  scene.nodes[1].position << even(1, 4), even(0, 1), 0;
  if (kind == 1) {
    for (auto& node : scene.nodes) node.support.kind = Support::Kind::clamped;
  }
  const double place = even(0.1, 0.9), mass = log(0.002, 0.05);
  if (kind == 2) scene.members[0].masses = {{std::round(20 * place) / 20, mass}};
  if (kind == 3) scene.members[0].masses = {{place, mass}};
  return scene;
}

}  // namespace rigfit::model::testing
