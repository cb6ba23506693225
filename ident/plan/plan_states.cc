// The states of a rig that a plan may choose from.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "ident/plan/plan.h"

namespace rigfit::ident {

std::vector<UpdateState> plan_states(const model::Scene& scene,
                                     const std::vector<double>& tensions_N,
                                     const std::vector<double>& lengths_m) {
  const auto tensioned =
      std::find_if(scene.members.begin(), scene.members.end(),
                   [](const auto& member) { return member.tension.has_value(); });
  if (!tensions_N.empty() && tensioned == scene.members.end()) {
    throw std::invalid_argument("other tensions need a cable whose tension the scene gives");
  }
  const auto& first = scene.members.front();
  if (!lengths_m.empty() &&
      (scene.members.size() != 1 || first.unstretched_length || first.stretch)) {
    throw std::invalid_argument(
        "other lengths need a scene of one member with no length of its own");
  }
  std::vector<std::optional<double>> tensions{std::nullopt}, lengths{std::nullopt};
  tensions.insert(tensions.end(), tensions_N.begin(), tensions_N.end());
  lengths.insert(lengths.end(), lengths_m.begin(), lengths_m.end());
  std::vector<UpdateState> states;
  for (const auto& length : lengths) {
    for (const auto& tension : tensions) {
      if (tension && tension == tensioned->tension) continue;  // as drawn
      UpdateState state{tension ? fmt::format("{:g} N", *tension) : "as drawn", scene, {}};
      for (auto& member : state.scene.members) {
        if (member.tension && tension) member.tension = tension;
      }
      if (length) {
        const auto node = [&](std::size_t end) {
          return std::find_if(state.scene.nodes.begin(), state.scene.nodes.end(),
                              [&](const auto& one) { return one.name == first.nodes[end]; });
        };
        const Eigen::Vector3d from = node(0)->position, along = node(1)->position - from;
        node(1)->position = from + *length * along.normalized();
        state.name += fmt::format(", {:g} m", *length);
      }
      states.push_back(std::move(state));
    }
  }
  return states;
}

}  // namespace rigfit::ident
