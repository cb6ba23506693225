#include "model/export/write_moordyn.h"

#include <fmt/format.h>

#include "model/scene/actual_state.h"
#include "model/scene/model_reduction.h"

namespace rigfit::model {
namespace {

constexpr int kUsualSegments = 30;

void require(bool good, const Scene& scene, const std::string& key, const char* problem) {
  if (!good) {
    throw SceneError({scene.file, 0, 0, key}, problem,
                     "MoorDyn's lines cannot say that: leave it "
                     "out, or export to CalculiX");
  }
}

double axial_damping(const Member& cable, double length) {
  if (cable.damping.axial > 0) return cable.damping.axial;
  return 2 * cable.damping_ratio.value_or(0) * length *
         std::sqrt(cable.EA * cable.mass_per_length) / M_PI;
}

}  // namespace

MoordynInput moordyn_input(const Scene& given, const Equilibrium& equilibrium) {
  const Scene scene = actual_state(given);
  const double gravity = -scene.gravity.y();
  require(gravity >= 0 && std::hypot(scene.gravity.x(), scene.gravity.z()) <= 1e-9 * gravity, scene,
          "gravity", "is not along -y");
  MoordynInput out;
  std::string types, points, lines;
  double lowest = 0, step_s = 1;
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const SceneNode& node = scene.nodes[i];
    require(node.support.kind != Support::Kind::elastic, scene, "node[" + std::to_string(i) + "]",
            "has springs to the ground");
    const bool fixed = node.support.kind != Support::Kind::free;
    if (node.support.kind == Support::Kind::clamped) {
      out.notes.push_back("node \"" + node.name + "\": clamped here, pinned in MoorDyn");
    }
    lowest = std::min(lowest, node.position.y());
    points += fmt::format("{:<4} {:<7} {:.9g} {:.9g} {:.9g} {:.9g} 0 0 0\n", i + 1,
                          fixed ? "Fixed" : "Free", node.position.x(), -node.position.z(),
                          node.position.y(), node.mass);
  }
  const auto number_of = [&](const std::string& name) {
    return index_named(scene, scene.nodes, name) + 1;
  };
  for (std::size_t m = 0; m < scene.members.size(); ++m) {
    const Member& cable = scene.members[m];
    const std::string key = "member[" + std::to_string(m) + "]";
    require(cable.kind == Member::Kind::cable, scene, key, "is a beam");
    require(cable.taper == 1 && cable.masses.empty(), scene, key, "is tapered or carries masses");
    const double length = equilibrium.members[m].unstretched_length_m;
    if (cable.EI[0] != cable.EI[1]) {
      out.notes.push_back("member \"" + cable.name + "\": one EI, the mean of both");
    }
    if (cable.GJ > 0 || cable.damping.bending > 0 || cable.damping.torsion > 0) {
      out.notes.push_back("member \"" + cable.name +
                          "\": torsion and the dampers of bending and torsion are left out");
    }
    const int segments = cable.segments > 0 ? cable.segments : kUsualSegments;
    // Half of 2 / omega of the highest axial mode, omega = 2 n / L sqrt(EA / m).
    step_s = std::min(step_s, length / segments * std::sqrt(cable.mass_per_length / cable.EA) / 2);
    const std::string type = "type" + std::to_string(m + 1);
    types +=
        fmt::format("{:<8} 0.0 {:.9g} {:.9g} {:.9g} {:.9g} 0 0 0 0\n", type, cable.mass_per_length,
                    cable.EA, axial_damping(cable, length), (cable.EI[0] + cable.EI[1]) / 2);
    lines += fmt::format("{:<4} {:<8} {} {} {:.12g} {} pt\n", m + 1, type,
                         number_of(cable.nodes[0]), number_of(cable.nodes[1]), length, segments);
  }
  if (!scene.loads.empty()) out.notes.push_back("loads are left out: MoorDyn's lines hang at rest");
  out.text = fmt::format(
      "---------------------- LINE TYPES ----------------------\n"
      "TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx\n"
      "(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)\n{}"
      "---------------------- POINTS ----------------------\n"
      "ID Attachment X Y Z Mass Volume CdA Ca\n"
      "(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)\n{}"
      "---------------------- LINES ----------------------\n"
      "ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs\n"
      "(#) (name) (#) (#) (m) (-) (-)\n{}"
      "---------------------- OPTIONS ----------------------\n"
      "2        writeLog\n"
      "{:.3g}  dtM      time step (s)\n"
      "0        rhoW     no water (kg/m^3)\n"
      "{:.9g}   g        gravity (m/s^2)\n"
      "{:.9g}   WtrDpth  below everything (m)\n"
      "0.01     dtIC     relaxation to rest (s)\n"
      "20       TmaxIC   (s)\n"
      "1e-6     threshIC\n"
      "---------------------- OUTPUTS ----------------------\n"
      "FairTen1\n"
      "END\n",
      types, points, lines, step_s, gravity, 1000 - lowest);
  return out;
}

}  // namespace rigfit::model
