#include "ident/update/problem/update_coordinate.h"

#include <algorithm>
#include <cmath>

#include "model/scene/actual_state.h"

namespace rigfit::ident {

double UpdateCoordinate::value(double q) const { return logarithmic ? std::exp(q) : q * scale; }
double UpdateCoordinate::derivative(double q) const { return logarithmic ? std::exp(q) : scale; }
double UpdateCoordinate::coordinate(double v) const {
  return logarithmic ? std::log(v) : v / scale;
}

bool may_be_negative(const std::string& name) {
  if (name == "load_cell.zero" || name == "temperature_change") return true;
  const auto dot = name.rfind('.');
  if (dot == std::string::npos) return false;
  const std::string last = name.substr(dot + 1);
  return last == "x" || last == "y" || last == "z" || last == "stretch" ||
         last.starts_with("direction_");
}

bool is_joint_damper(const std::string& name) {
  return name.ends_with(".damping_axial") || name.ends_with(".damping_bending") ||
         name.ends_with(".damping_torsion");
}

double scale_at_zero(const model::Scene& scene, const std::string& name) {
  if (name == "load_cell.zero") {
    double tension = 0;
    for (const auto& member : scene.members)
      tension = std::max(tension, member.tension.value_or(0));
    return 0.01 * tension;
  }
  double mass = 0;
  for (const auto& member : scene.members) {
    mass += member.mass_per_length * model::chord_of(scene, member).norm();
  }
  return name.ends_with(".mass") && mass > 0 ? 0.01 * mass : 1;
}

}  // namespace rigfit::ident
