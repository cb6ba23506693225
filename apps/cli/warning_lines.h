// Warnings of a run as lines for a terminal: those of one kind (code) in one line, the kinds that
// can change an answer first, and no more lines than a person reads. The JSON document and the
// report hold each by itself.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rigfit::apps {

struct Warning {
  std::string code;  ///< stable, for programs
  std::string message;
  std::string where;     ///< file, channel, member ...
  bool refused = false;  ///< the run ends with exit code 4 for it
};

/// 0: the answer may be wrong or is missing; 1: what a person should look at; 2: what is allowed
/// for in the values or taken as said.
[[nodiscard]] int rank_of_warning(std::string_view code);

/// Lines without their end. With more than `most` kinds, `most` - 1 of them, the lowest ranks first
/// and then in the order they were said, and a line that counts the others.
[[nodiscard]] std::vector<std::string> warning_lines(std::span<const Warning> warnings,
                                                     std::size_t most = 8);

}  // namespace rigfit::apps
