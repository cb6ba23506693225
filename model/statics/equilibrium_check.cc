#include <fmt/format.h>

#include "model/statics/equilibrium.h"

namespace rigfit::model {
namespace {

std::string name_at(const Chain& chain, const Numbering& numbering, int row, const Scene& scene) {
  for (const Segment& s : chain.segments) {
    const int k = static_cast<int>(&s - chain.segments.data());
    const bool here = numbering.twist[k] == row ||
                      (numbering.displacement.col(s.a).array() == row).any() ||
                      (numbering.displacement.col(s.b).array() == row).any();
    if (here) return scene.members[at(s.member)].name;
  }
  for (Index r = 0; r < numbering.rotation.cols(); ++r) {
    if ((numbering.rotation.col(r).array() == row).any()) {
      return scene.nodes[static_cast<std::size_t>(chain.rotating_node[std::size_t(r)])].name;
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

double mean_force(const Chain& chain, const ChainMember& member, const VectorXd& axial) {
  double mean = 0;
  for (int k = member.first_segment; k < member.first_segment + member.segments; ++k) {
    mean += axial[k] * chain.segments[at(k)].length / member.unstretched_length;
  }
  return mean;
}

const char* how_to_tighten(const Member& cable) {
  if (cable.unstretched_length) return "give it a shorter unstretched_length";
  if (cable.stretch) return "give it a larger stretch";
  return "give it a larger tension";
}

void judge_rest(const Chain& chain, const Scene& scene, ChainEquilibrium& result) {
  const auto refuse = [&](EquilibriumStatus status, std::string reason) {
    result.status = status;
    result.reason = std::move(reason);
  };
  const VectorXd axial = axial_forces(chain, result.state);
  for (std::size_t m = 0; m < chain.members.size(); ++m) {
    const ChainMember& member = chain.members[m];
    if (!member.cable) continue;
    const Member& given = scene.members[m];
    const double mean = mean_force(chain, member, axial);
    const double least = axial.segment(member.first_segment, member.segments).minCoeff();
    const bool limp = given.EI[0] == 0 && given.EI[1] == 0;
    if (!(mean > 0) || (limp && !(least > 0))) {
      return refuse(EquilibriumStatus::slack,
                    fmt::format("cable \"{}\" is slack: its axial force is {:.4g} N{}; {}",
                                given.name, limp ? least : mean,
                                limp ? " at one end" : " on average", how_to_tighten(given)));
    }
  }
  const std::vector<Motion> motions =
      chain.planar ? std::vector<Motion>{Motion::in_plane, Motion::out_of_plane}
                   : std::vector<Motion>{Motion::space};
  std::vector<RestMotion> found;
  for (const Motion motion : motions) {
    auto assembly = std::make_unique<Assembly>(chain, motion);
    if (assembly->size() == 0) continue;
    VectorXd force(assembly->size());
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
      return refuse(
          EquilibriumStatus::mechanism,
          fmt::format(
              "\"{}\" can twist without any force: its bending stiffnesses differ and its GJ "
              "is zero, a mechanism; give it a GJ, or one EI",
              twisting->name));
    }
    if (!regular) {
      return refuse(
          EquilibriumStatus::mechanism,
          fmt::format("\"{}\" can move{} without any force: a mechanism; give one of its nodes a "
                      "support, or join it rigidly to what holds it",
                      name_at(chain, assembly->numbering(), factor.smallest_pivot_row(), scene),
                      where));
    }
    if (factor.negative_pivots() > 0) {
      return refuse(
          EquilibriumStatus::buckled,
          fmt::format(
              "the state is unstable{} ({} direction{} of negative stiffness): "
              "a member has buckled under its load; raise its EI, lower its load or brace it",
              where, factor.negative_pivots(), factor.negative_pivots() > 1 ? "s" : ""));
    }
    found.push_back({motion, std::move(assembly), std::move(tangent)});
  }
  result.status = EquilibriumStatus::converged;
  result.motions = std::move(found);
}

}  // namespace rigfit::model
