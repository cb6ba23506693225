// The cells of a line in a small text table.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rigfit::apps {

/// Without blanks, quotes and the line's end around it.
[[nodiscard]] std::string trimmed(std::string_view text);

[[nodiscard]] std::vector<std::string> cells_of(std::string_view line, char separator);

}  // namespace rigfit::apps
