// A cable built in the program -> static equilibrium, natural modes, derivative by the tension.
#include <cstdio>
#include <exception>
#include <string>

#include "model/linear/modal_analysis.h"
#include "model/scene/scene.h"

namespace {

rigfit::model::Scene cable() {
  using namespace rigfit::model;
  Scene scene;
  for (const double x : {0.0, 2.4}) {  // m
    SceneNode node;
    node.name = x > 0 ? "right" : "left";
    node.position = {x, 0, 0};
    node.support.kind = Support::Kind::pinned;
    scene.nodes.push_back(node);
  }
  Member member;
  member.name = "cable";
  member.nodes = {"left", "right"};
  member.segments = 40;
  member.mass_per_length = 0.16667;  // kg/m
  member.EA = 221780;                // N
  member.EI = {0.5972, 0.5972};      // N m2
  member.tension = 200;              // N
  scene.members.push_back(member);
  return scene;
}

}  // namespace

int main() try {
  using namespace rigfit;
  const model::Scene scene = cable();
  const std::string tension = scene.members.back().name + ".tension";
  const model::ModeSensitivities result = model::analyse_mode_sensitivities(scene, {tension});
  const model::Equilibrium& rest = result.analysis.equilibrium;
  if (rest.status != model::EquilibriumStatus::converged) {
    std::fprintf(stderr, "%s\n", rest.reason.c_str());
    return 5;
  }
  for (const auto& member : rest.members) {
    std::printf("%s: sag %.4f mm\n", member.member.c_str(), 1e3 * member.sag_m);
  }
  for (std::size_t i = 0; i < result.analysis.modes.size(); ++i) {
    const model::NaturalMode& mode = result.analysis.modes[i];
    std::printf("%9.5f Hz %-7s %.5f Hz per N of %s\n", mode.frequency_hz, name_of(mode.plane),
                result.frequency(static_cast<Eigen::Index>(i), 0), tension.c_str());
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 3;
}
