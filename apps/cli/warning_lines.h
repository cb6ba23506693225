// Findings of a run have two levels. A warning asks for something or casts doubt on an answer; a
// note says what was done (a start chosen, a column left out, hits rejected). On a terminal
// warnings of one kind (code) share a line, those that can change an answer stand first, and five
// lines are enough; notes are for --verbose. The JSON document and the report hold each by itself.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ident/statistics/finding.h"

namespace rigfit::apps {

using ident::Finding;

enum class Level { answer_may_be_wrong, look_at, taken_as_said, note };

[[nodiscard]] Level level_of(std::string_view code);
[[nodiscard]] inline bool is_note(std::string_view code) { return level_of(code) == Level::note; }

/// Lines without their end, the gravest level first and then in the order they were said; with more
/// than `most` kinds a last line counts the others.
[[nodiscard]] std::vector<std::string> warning_lines(std::span<const Finding> warnings,
                                                     std::size_t most = 5);

}  // namespace rigfit::apps
