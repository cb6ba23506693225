#include "model/statics/equilibrium_check.h"

#include <fmt/format.h>

#include <vector>

namespace rigfit::model {
namespace {

std::string name_at(const Chain& chain, const Numbering& numbering, int row, const Scene& scene) {
  for (const Segment& s : chain.segments) {
    const int k = static_cast<int>(&s - chain.segments.data());
    bool here = numbering.twist[k] == row;
    for (int axis = 0; axis < 3; ++axis) {
      here = here || numbering.displacement(axis, s.a) == row ||
             numbering.displacement(axis, s.b) == row;
    }
    if (here) return scene.members[static_cast<std::size_t>(s.member)].name;
  }
  for (Eigen::Index r = 0; r < numbering.rotation.cols(); ++r) {
    for (int axis = 0; axis < 3; ++axis) {
      if (numbering.rotation(axis, r) == row) {
        return scene.nodes[static_cast<std::size_t>(chain.rotating_node[std::size_t(r)])].name;
      }
    }
  }
  return "the rig";
}

/// A member that can bend differently about its axes and turn about its own without resistance.
const Member* free_to_twist(const Scene& scene) {
  for (const Member& member : scene.members) {
    if (member.EI[0] != member.EI[1] && !(member.GJ > 0)) return &member;
  }
  return nullptr;
}

}  // namespace

double mean_force(const Chain& chain, const ChainMember& member, const Eigen::VectorXd& axial) {
  double mean = 0;
  for (int k = member.first_segment; k < member.first_segment + member.segments; ++k) {
    mean += axial[k] * chain.segments[std::size_t(k)].length / member.unstretched_length;
  }
  return mean;
}

const char* how_to_tighten(const Member& cable) {
  if (cable.unstretched_length) return "give it a shorter unstretched_length";
  if (cable.stretch) return "give it a larger stretch";
  return "give it a larger tension";
}

std::vector<RestMotion> judge_rest(const Chain& chain, const Scene& scene,
                                   ChainEquilibrium& result) {
  const Eigen::VectorXd axial = axial_forces(chain, result.state);
  for (const ChainMember& member : chain.members) {
    if (!member.cable) continue;
    const Member& given = scene.members[static_cast<std::size_t>(member.scene_member)];
    const double mean = mean_force(chain, member, axial);
    const double least = axial.segment(member.first_segment, member.segments).minCoeff();
    const bool limp = given.EI[0] == 0 && given.EI[1] == 0;
    if (!(mean > 0) || (limp && !(least > 0))) {
      result.status = EquilibriumStatus::slack;
      result.reason = fmt::format("cable \"{}\" is slack: its axial force is {:.4g} N{}; {}",
                                  given.name, limp ? least : mean,
                                  limp ? " at one end" : " on average", how_to_tighten(given));
      return {};
    }
  }
  const std::vector<Motion> motions =
      chain.planar ? std::vector<Motion>{Motion::in_plane, Motion::out_of_plane}
                   : std::vector<Motion>{Motion::space};
  std::vector<RestMotion> found;
  for (const Motion motion : motions) {
    auto assembly = std::make_unique<Assembly>(chain, motion);
    if (assembly->size() == 0) continue;
    Eigen::VectorXd force(assembly->size());
    EnvelopeMatrix tangent = assembly->matrix();
    assembly->force_and_tangent(result.state, force, tangent);
    EnvelopeFactor factor;
    const bool regular = factor.factor(tangent, 1e-14);
    const char* where = motion == Motion::in_plane       ? " in its plane"
                        : motion == Motion::out_of_plane ? " out of its plane"
                                                         : "";
    const Member* twisting =
        regular && factor.negative_pivots() == 0 ? nullptr : free_to_twist(scene);
    if (twisting) {
      result.status = EquilibriumStatus::mechanism;
      result.reason = fmt::format(
          "\"{}\" can twist without any force: its bending stiffnesses differ and its GJ is zero, "
          "a "
          "mechanism; give it a GJ, or one EI",
          twisting->name);
      return {};
    }
    if (!regular) {
      result.status = EquilibriumStatus::mechanism;
      result.reason = fmt::format(
          "\"{}\" can move{} without any force: a mechanism; give one of its nodes a support, or "
          "join it rigidly to what holds it",
          name_at(chain, assembly->numbering(), factor.smallest_pivot_row(), scene), where);
      return {};
    }
    if (factor.negative_pivots() > 0) {
      result.status = EquilibriumStatus::buckled;
      result.reason = fmt::format(
          "the state is unstable{} ({} direction{} of negative stiffness): "
          "a member has buckled under its load; raise its EI, lower its load or brace it",
          where, factor.negative_pivots(), factor.negative_pivots() > 1 ? "s" : "");
      return {};
    }
    found.push_back({motion, std::move(assembly), std::move(tangent)});
  }
  result.status = EquilibriumStatus::converged;
  return found;
}

}  // namespace rigfit::model
