// What a verb is: described options, and a function from them to its JSON result. And what the
// program says of itself, all of it from these options.
#pragma once

#include <nlohmann/json.hpp>
#include <ostream>

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
  Json (*schema)() = nullptr;  ///< its result's
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

// Help by `rigfit help WORD`, the word most like a misspelt one (usage.cc).

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

// Texts of options that name something: "cable.EI=0.6,0.02", "tip.mass=5%", "left.EI,-right.EI".

/// Name and text of "NAME=TEXT"; throws UsageError with the option's name and `form`, how it is to
/// be written, where the name, or TEXT unless it `may_be_empty`, is empty.
[[nodiscard]] std::pair<std::string, std::string> named_text(const std::string& option,
                                                             const std::string& text,
                                                             const std::string& form,
                                                             bool may_be_empty = false);

struct NamedNumbers {
  std::string name;
  std::vector<double> numbers;
  bool relative = false;  ///< the only number was in percent, and is given as a ratio
};

/// "NAME=NUMBER,NUMBER ..." with `fewest` to `most` numbers, or "NAME=NUMBER%" where `percent`
/// allows it. Numbers are finite, the last one positive. Throws UsageError as above.
[[nodiscard]] NamedNumbers named_numbers(const std::string& option, const std::string& text,
                                         const std::string& form, std::size_t fewest,
                                         std::size_t most, bool percent = false);

struct SignedNames {
  std::vector<std::string> names;
  std::vector<double> signs;  ///< 1; -1 where the name stands behind a minus
};

/// "NAME,-NAME". Throws UsageError for an empty name.
[[nodiscard]] SignedNames signed_names(const std::string& option, const std::string& text);

}  // namespace rigfit::apps
