// What tests of fits share: modes as a test would give them, options of a plain fit.
#pragma once

#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include "ident/update/model_update.h"
#include "model/linear/modal_analysis.h"
#include "tests/scenes.h"

namespace rigfit::ident::testing {

/// Starts where it is; the data have the model's segments.
inline UpdateOptions plain_options() {
  UpdateOptions options{.starts = 1, .segment_uncertainty = false};
  return options;
}

/// A vertical cantilever "beam" from "base" to "tip", 0.75 m, of 0.3 kg/m; its second EI is so high
/// that its low modes are all in the plane.
inline model::Scene beam(double EI, double tip_mass, int segments = 12) {
  auto scene = model::testing::vertical_beam(0.75, EI, 0.3, segments);
  scene.members[0].EI[1] = 200;
  scene.nodes[1].mass = tip_mass;
  return scene;
}

/// A frequency without damping ratio or shape.
inline MeasuredMode mode_of(double hz, double std_hz,
                            std::optional<model::ModePlane> plane = model::ModePlane::in) {
  return {
      .frequency_hz = {hz, std_hz}, .damping_ratio = {std::nan(""), std::nan("")}, .plane = plane};
}

/// The first modes of a plane, known to a relative `std`, and off by that with `random`.
inline std::vector<MeasuredMode> modes_of(const model::Scene& truth, model::ModePlane plane,
                                          std::size_t count, double std,
                                          std::mt19937_64* random = nullptr) {
  std::normal_distribution<double> normal;
  std::vector<MeasuredMode> modes;
  for (const auto& mode :
       model::analyse_modes(truth, {.count = 3 * static_cast<int>(count) + 8}).modes) {
    if (mode.plane != plane || modes.size() == count) continue;
    const double off = random != nullptr ? std * normal(*random) : 0;
    modes.push_back(mode_of(mode.frequency_hz * (1 + off), std * mode.frequency_hz, plane));
  }
  return modes;
}

}  // namespace rigfit::ident::testing
