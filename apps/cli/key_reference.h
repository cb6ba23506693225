// Every key of scenes, campaigns and the TOML files beside recordings, for `rigfit help`: of
// campaigns from their description (apps/campaign/campaign.h), else the tables of apps/README.md,
// which a test compares with the keys that the readers know.
#pragma once

#include <string>

namespace rigfit::apps {

/// Text for a terminal on "scene", "campaign" or "sidecar"; empty for another word.
[[nodiscard]] std::string key_reference(const std::string& document);

}  // namespace rigfit::apps
