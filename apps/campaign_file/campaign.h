// A campaign: what was tested on a rig, how, which scenes stand for it, what to fit and which
// published or earlier results to compare with. One TOML file; paths in it are relative to it. Its
// keys: apps/campaign/campaign.h, `rigfit help campaign`.
//
// Every key is checked like a scene's; the scenes and tables it names are read and checked too.
#pragma once

#include <filesystem>
#include <string_view>

#include "apps/campaign/campaign.h"

namespace rigfit::apps {

/// Throws model::SceneError.
[[nodiscard]] Campaign read_campaign(const std::filesystem::path& path);
/// The same from text; `path` is named in messages, and what the text names lies beside it.
[[nodiscard]] Campaign parse_campaign(std::string_view text, const std::filesystem::path& path);

}  // namespace rigfit::apps
