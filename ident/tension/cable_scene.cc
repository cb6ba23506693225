#include "ident/tension/cable_scene.h"

#include <cmath>
#include <limits>
#include <string>

#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

double angle_of(const CableDescription& cable) {
  return cable.inclination_deg * signal::kTwoPi / 360;
}

}  // namespace

double axial_rigidity(const CableDescription& cable, double tension_N) {
  return cable.EA_N ? cable.EA_N->value : tension_N / kAssumedStrain;
}

double weight_across(const CableDescription& cable) {
  return cable.mass_per_length.value * cable.gravity * std::cos(angle_of(cable));
}

double irvine_parameter(const CableDescription& cable, double tension_N) {
  const double slope = weight_across(cable) * cable.length_m.value / tension_N;
  return slope * slope * axial_rigidity(cable, tension_N) / (tension_N * (1 + slope * slope / 8));
}

double scene_tension_factor(const CableDescription& cable) {
  constexpr double kSteep = 0.0872;  // cos of 85 degrees, from which a scene's tension is axial
  const double level = std::cos(angle_of(cable));
  return level > kSteep ? level : 1;
}

model::Scene cable_scene(const CableDescription& cable, CableEnds ends, double tension_N,
                         double EI_Nm2) {
  model::Scene scene;
  scene.title = std::string("cable, ") + name_of(ends) + " ends";
  scene.gravity = {0, -cable.gravity, 0};
  const double angle = angle_of(cable), L = cable.length_m.value;
  scene.nodes.resize(2);
  scene.nodes[0].name = "start";
  scene.nodes[1].name = "end";
  scene.nodes[1].position = {L * std::cos(angle), L * std::sin(angle), 0};
  for (auto& node : scene.nodes) {
    const bool pinned = ends == CableEnds::pinned ||
                        (ends == CableEnds::pinned_clamped && &node == &scene.nodes.front());
    node.support.kind = pinned ? model::Support::Kind::pinned : model::Support::Kind::clamped;
    if (ends == CableEnds::springs) {
      node.support.kind = model::Support::Kind::elastic;
      node.support.translational.setConstant(std::numeric_limits<double>::infinity());
      node.support.rotational.setConstant(10 * EI_Nm2 / L);
    }
  }
  model::Member member;
  member.name = "cable";
  member.nodes = {"start", "end"};
  const double EA = axial_rigidity(cable, tension_N);
  const bool installed = cable.mass_reference == MassReference::installed;
  member.mass_per_length = cable.mass_per_length.value * (installed ? 1 + tension_N / EA : 1);
  member.EA = EA;
  member.EI = {EI_Nm2, EI_Nm2};
  member.GJ = EI_Nm2;
  member.tension = tension_N * scene_tension_factor(cable);
  member.masses = cable.masses;
  scene.members.push_back(member);
  return scene;
}

}  // namespace rigfit::ident
