// A scene drawn to scale, seen from the side: members, supports, masses, sensors and where it is
// struck or released.
#pragma once

#include <string>

#include "model/scene/scene.h"

namespace rigfit::apps {

/// An svg element with the page's classes; its own colours hold where there is no page. Sensors
/// and loads are numbered, the list below the drawing names them.
[[nodiscard]] std::string rig_drawing(const model::Scene& scene);

/// Nodes, sensors and loads with their places in metres, as CSV.
[[nodiscard]] std::string rig_places(const model::Scene& scene);

}  // namespace rigfit::apps
