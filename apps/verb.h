// What a verb is: options bound to the command line, and a function from them to its JSON result.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "apps/exit_code.h"

namespace rigfit::apps {

using Json = nlohmann::ordered_json;

struct Warning {
  std::string code;  ///< stable, for programs
  std::string message;
  std::string where;  ///< file, channel, member ...
};

/// What every verb gets from the common options, and what it leaves behind besides its result.
class VerbContext {
 public:
  explicit VerbContext(std::ostream& out_stream) : out(out_stream) {}

  std::ostream& out;  ///< for people; a sink when JSON goes to standard output or with --quiet
  bool quiet = false;
  int threads = 1;
  std::uint64_t seed = 1;
  std::vector<std::string> command;  ///< as typed, for provenance

  ExitCode exit_code = ExitCode::done;

  /// Recorded in the document and, unless quiet, said on standard error.
  void warn(std::string code, std::string message, std::string where = "");
  /// A warning that also ends the run with exit code 4: part of what was asked cannot be had.
  void refuse(std::string code, std::string message, std::string where = "");
  /// Names a file as an input of this run (hashed into the document).
  void input(const std::string& path);

  const std::vector<Warning>& warnings() const { return warnings_; }
  const std::vector<std::string>& inputs() const { return inputs_; }

 private:
  std::vector<Warning> warnings_;
  std::vector<std::string> inputs_;
};

struct Verb {
  CLI::App* app = nullptr;
  std::function<Json(VerbContext&)>
      run;  ///< the verb's own keys; the envelope is added around them
};

using Verbs = std::vector<Verb>;

/// Adds every verb, with its options, to the program (verbs/all.cc lists them).
void add_all_verbs(CLI::App& program, Verbs& verbs);

}  // namespace rigfit::apps
