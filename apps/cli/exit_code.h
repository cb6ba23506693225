// How a run ended, as scripts see it, and the exceptions by which a verb ends early.
#pragma once

#include <exception>
#include <stdexcept>
#include <string>
#include <utility>

namespace rigfit::apps {

enum class ExitCode : int {
  done = 0,
  fault = 1,  ///< ours
  wrong_usage = 2,
  bad_input = 3,  ///< an input cannot be read
  refused = 4,    ///< the data cannot support what was asked
  not_converged = 5,
};

/// Ends a run with an exit code.
class Ended : public std::runtime_error {
 public:
  Ended(const std::string& message, ExitCode code) : std::runtime_error(message), exit_code(code) {}
  const ExitCode exit_code;
};
template <ExitCode kCode>
struct EndedBy : Ended {
  explicit EndedBy(const std::string& message) : Ended(message, kCode) {}
};
/// The call makes no sense (options that exclude each other, an output folder that is a file).
using UsageError = EndedBy<ExitCode::wrong_usage>;
/// A computation did not converge.
using NotConverged = EndedBy<ExitCode::not_converged>;
/// An input is no longer what it was when the run began.
using InputChanged = EndedBy<ExitCode::bad_input>;
/// An output cannot be written: path, reason and remedy.
using OutputError = EndedBy<ExitCode::bad_input>;

/// Ends a verb without a result: the data cannot support what was asked. A verb that has a partial
/// result sets `VerbContext::exit_code` by `refuse` instead and returns that result. `code` is the
/// finding's code, which stays the same from version to version.
struct Refused : EndedBy<ExitCode::refused> {
  explicit Refused(const std::string& message, std::string finding_code = "refused")
      : EndedBy(message), code(std::move(finding_code)) {}
  const std::string code;
};

/// The exit code that an exception stands for.
[[nodiscard]] ExitCode exit_code_of(const std::exception& error);

}  // namespace rigfit::apps
