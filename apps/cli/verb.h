// What a verb is: described options, and a function from them to its JSON result.
#pragma once

#include <nlohmann/json.hpp>

#include "apps/cli/verb_context.h"
#include "apps/describe/option.h"

namespace rigfit::apps {

struct Verb {
  std::string name, does;
  std::string example;  ///< below the options in its help
  describe::Options options;
  /// The verb's own keys; the envelope is added around them.
  std::function<Json(VerbContext&)> run;
  bool draws = false;          ///< takes --plot: adds figures to VerbContext::plots
  bool reads = false;          ///< its files are recordings: takes the options of reading
  Json (*schema)() = nullptr;  ///< of its result
};

using Verbs = std::vector<Verb>;

/// A verb of a struct of options, for which there is `options_of`.
template <class Command>
[[nodiscard]] Verb verb_of(std::string name, std::string does, std::string example,
                           Json (*run)(Command&, VerbContext&), bool draws, bool reads,
                           Json (*schema)()) {
  auto command = std::make_shared<Command>();
  return {std::move(name),
          std::move(does),
          std::move(example),
          options_of(*command),
          [command, run](VerbContext& context) { return run(*command, context); },
          draws,
          reads,
          schema};
}

/// What a person says of every recording of a run, as in the TOML file beside it.
[[nodiscard]] describe::Options options_of(signal::ReadOptions& reading);

/// What stands beside a verb's own options; most of it goes straight into the context of the run.
struct SharedOptions {
  std::string json;
  std::string plot;  ///< ends with .html, .svg or .png; empty: no figures

  /// For a verb that reads recordings, that draws.
  [[nodiscard]] describe::Options options(VerbContext& context, bool reads, bool draws);
};

/// Every verb, in the order in which a person goes from recordings to a report.
[[nodiscard]] Verbs all_verbs();

}  // namespace rigfit::apps
