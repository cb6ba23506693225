// What a verb is: options bound to the command line, and a function from them to its JSON result.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <nlohmann/json.hpp>
#include <vector>

#include "apps/cli/verb_context.h"

namespace rigfit::apps {

using Json = nlohmann::ordered_json;

struct Verb {
  CLI::App* app = nullptr;
  std::function<Json(VerbContext&)>
      run;             ///< the verb's own keys; the envelope is added around them
  bool draws = false;  ///< takes --plot: adds figures to VerbContext::plots
};

using Verbs = std::vector<Verb>;

/// Adds every verb, with its options, to the program (verbs/all.cc lists them).
void add_all_verbs(CLI::App& program, Verbs& verbs);

}  // namespace rigfit::apps
