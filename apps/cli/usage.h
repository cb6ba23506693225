// What the program says of itself: help by `rigfit help WORD`, the word most like a misspelt one.
// All of it from the described options of the verbs.
#pragma once

#include <ostream>

#include "apps/cli/verb.h"

namespace rigfit::apps {

[[nodiscard]] std::string verb_help(const Verb& verb, std::size_t width);

/// Answers `rigfit help ...` (`arguments`: what stands behind "help"), as wide as the terminal.
/// Throws UsageError.
void help(const Verbs& verbs, const std::vector<std::string>& arguments, std::ostream& out);

/// Every key of a "scene", a "campaign" or a "sidecar", for a terminal: of campaigns from their
/// description, else the tables of apps/README.md, which a test compares with the keys that the
/// readers know. Empty for another word.
[[nodiscard]] std::string key_reference(const std::string& document);

/// The verb of that name; throws UsageError with the nearest.
[[nodiscard]] const Verb& verb_named(const Verbs& verbs, const std::string& name);

/// "; did you mean --channel?", or nothing where none is near.
[[nodiscard]] std::string did_you_mean(const std::string& word,
                                       const std::vector<std::string>& words);

[[nodiscard]] std::vector<std::string> names_of(const describe::Options& options);

/// Sets what `arguments` (behind the verb's name) give; in command_line.cc, the only file that
/// knows CLI11. Throws UsageError, with the nearest option where one is misspelt.
void parse_options(const Verb& verb, const std::vector<std::string>& arguments);

}  // namespace rigfit::apps
