// The commented campaign that `new` writes, with the files it names: an example that runs.
#pragma once

#include <string_view>
#include <utility>
#include <vector>

namespace rigfit::apps {

/// Path in the campaign's folder, content.
[[nodiscard]] std::vector<std::pair<std::string_view, std::string_view>> new_campaign_files();

}  // namespace rigfit::apps
