#include "apps/cli/at_hand.h"

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

void tell_notes(const signal::Recording& recording, VerbContext& context) {
  const std::string file = recording.path.string();
  for (const auto& note : recording.notes) {
    context.warn(note.code, note.message, note.where.empty() ? file : file + ": " + note.where);
  }
}

}  // namespace rigfit::apps
