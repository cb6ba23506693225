// The beam with two cables of the virtual laboratory, for tests and tables of fits to its modes.
#pragma once

#include <complex>
#include <random>
#include <string>
#include <vector>

#include "ident/update/problem/update_data.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/read_scene.h"

namespace rigfit::ident::testing {

inline constexpr double kLaboratoryEI = 2.17;  // N m2, of the beam

/// `laboratory`: its folder in testdata. `folder`: "truth", or "scenes" for what was known before;
/// the cables' EI and EA are the truth's.
inline model::Scene laboratory_rig(const std::string& laboratory, const std::string& folder,
                                   double tension, int segments) {
  model::Scene scene = model::read_scene(laboratory + "/" + folder + "/rig.toml");
  for (auto& member : scene.members) member.segments = segments;
  for (const std::string cable : {"left cable.", "right cable."}) {
    model::set_parameter(scene, cable + "tension", tension);
    model::set_parameter(scene, cable + "EI", 0.674);
    model::set_parameter(scene, cable + "EA", 205000);
  }
  return scene;
}

/// Modes in the plane below 60 Hz with normal errors of these relative standard deviations.
inline std::vector<MeasuredMode> laboratory_modes(const std::string& laboratory, double tension,
                                                  int segments, double frequency_std,
                                                  double damping_std, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<MeasuredMode> measured;
  const auto truth = laboratory_rig(laboratory, "truth", tension, segments);
  for (const auto& mode : model::analyse_modes(truth, {.count = 24, .damped = true}).modes) {
    if (mode.plane != model::ModePlane::in || mode.frequency_hz > 60) continue;
    const double f = mode.frequency_hz * (1 + frequency_std * normal(random));
    const double damping = mode.damping_ratio * (1 + damping_std * normal(random));
    measured.push_back({{f, frequency_std * f},
                        {damping, damping_std * damping},
                        mode.plane,
                        mode.sensor_shape.cast<std::complex<double>>()});
  }
  return measured;
}

/// The tension of each state, the beam's EI, the mass at its tip, damping of cables and beam.
inline std::vector<FreeParameter> laboratory_parameters() {
  FreeParameter tension{"tension", {"left cable.tension", "right cable.tension"}};
  tension.per_state = true;
  return {{"beam.EI_z"},
          {"tip.mass"},
          tension,
          {"cable damping", {"left cable.damping_ratio", "right cable.damping_ratio"}},
          {"beam.damping_ratio"}};
}

}  // namespace rigfit::ident::testing
