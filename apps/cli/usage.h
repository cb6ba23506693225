// What the program says of itself: help by `rigfit help WORD`, the word most like a misspelt verb
// or option, completion of bash and zsh, man pages. All of it from the options that CLI11 parses.
#pragma once

#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "apps/cli/verb.h"

namespace rigfit::apps {

/// Answers `rigfit help ...` (`arguments`: what stands behind "help"). Returns the exit code.
[[nodiscard]] int help(CLI::App& program, const Verbs& verbs,
                       const std::vector<std::string>& arguments, std::ostream& out);

/// Help with types in words ("NUMBER in [0 - 1]"). Verbs added to a program after it was set have
/// it too.
[[nodiscard]] std::shared_ptr<CLI::FormatterBase> help_formatter();

/// What is wrong with a command line that CLI11 refused, with the nearest word where a verb or an
/// option is misspelt; `message`: CLI11's own.
[[nodiscard]] std::string usage_error(const Verbs& verbs, const std::vector<std::string>& arguments,
                                      const std::string& message);

/// Completion scripts: verbs, their options, files.
[[nodiscard]] std::string bash_completion(const Verbs& verbs);
/// The same for zsh.
[[nodiscard]] std::string zsh_completion(const Verbs& verbs);

/// Manual page in roff: of the program, or of a verb.
[[nodiscard]] std::string man_page(const CLI::App& program, const Verbs& verbs, const Verb* verb,
                                   const std::string& version);

}  // namespace rigfit::apps
