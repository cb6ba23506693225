// The command line into the options of a verb: the only file that knows CLI11.
#pragma once

#include <string>
#include <vector>

#include "apps/cli/verb.h"

namespace rigfit::apps {

/// Sets what `arguments` (behind the verb's name) give. Throws UsageError, with the nearest option
/// where one is misspelt.
void parse_options(const Verb& verb, const std::vector<std::string>& arguments);

}  // namespace rigfit::apps
