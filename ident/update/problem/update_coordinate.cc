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

double UpdateCoordinate::step(double q) const {
  return half_held > 0 ? 1 / (1 + half_held * std::exp(-q)) : q;
}
double UpdateCoordinate::from_step(double u) const {
  return half_held > 0 ? std::log(half_held * u / (1 - u)) : u;
}
double UpdateCoordinate::step_derivative(double u) const {
  return half_held > 0 ? 1 / (u * (1 - u)) : 1;
}

void UpdateCoordinate::step_by_fixity(double half) {
  constexpr double kTold = 1e-12;  // from 1, with four digits
  half_held = half;
  const auto [least, most] = step_bounds();
  if (!(half > 0) || !(least > kTold) || !(1 - most > kTold)) half_held = 0;
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

double half_held(const model::Scene& scene, const std::string& name) {
  const auto dot = name.rfind(".rotational_");
  if (dot == std::string::npos) return 0;
  const std::string node = name.substr(0, dot);
  const Eigen::Index i = name.back() - 'x';
  double half = 0;
  Eigen::Index axis = -1;
  for (const auto& member : scene.members) {
    if (member.nodes[0] != node && member.nodes[1] != node) continue;
    const Eigen::Vector3d along = model::chord_of(scene, member);
    Eigen::Index own = 0;
    const double length = along.norm();
    if (along.cwiseAbs().maxCoeff(&own) < 0.95 * length || own == i) return 0;
    if (axis >= 0 && own != axis) return 0;
    const double EI = member.EI[i == 2 ? 0 : 1];
    if (axis < 0) half = 3 * EI / length + std::sqrt(EI * std::abs(member.tension.value_or(0)));
    axis = own;
  }
  return half;
}

}  // namespace rigfit::ident
