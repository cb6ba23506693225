#include "apps/cli/at_hand.h"

#include <fmt/format.h>

#include "model/scene/actual_state.h"
#include "model/scene/read_scene.h"

namespace rigfit::apps {

std::shared_ptr<const signal::Recording> recording_at_hand(const std::string& key,
                                                           const VerbContext& context) {
  if (!context.at_hand) return nullptr;
  const auto known = context.at_hand->recordings.find(key);
  return known == context.at_hand->recordings.end() ? nullptr : known->second;
}

model::Scene scene_of(const std::string& key, VerbContext& context) {
  if (context.at_hand) {
    const auto known = context.at_hand->scenes.find(key);
    if (known != context.at_hand->scenes.end()) return *known->second;
  }
  context.input(key);
  return model::read_scene(key);
}

void warn_of_mass(const model::Scene& scene, const std::string& file, VerbContext& context) {
  const double strain = model::undecided_mass(scene);
  if (strain == 0) return;
  context.warn(
      "mass_of",
      fmt::format("say mass_of = \"installed\" or \"unstretched\" of the cables: which one "
                  "changes the mass by {:.2g} %, frequencies by half of that",
                  100 * strain),
      file);
}

void tell_notes(const signal::Recording& recording, VerbContext& context) {
  const std::string file = recording.path.string();
  for (const auto& note : recording.notes) {
    context.warn(note.code, note.message, note.where.empty() ? file : file + ": " + note.where);
  }
}

}  // namespace rigfit::apps
