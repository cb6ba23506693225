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

/// Ends a verb whose call makes no sense (options that exclude each other, an output folder that is
/// a file).
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Ends a verb without a result: the data cannot support what was asked. A verb that has a partial
/// result sets `VerbContext::exit_code` by `refuse` instead and returns that result. `code` is the
/// finding's code, which stays the same from version to version.
class Refused : public std::runtime_error {
 public:
  explicit Refused(const std::string& message, std::string code = "refused")
      : std::runtime_error(message), code_(std::move(code)) {}
  [[nodiscard]] const std::string& code() const { return code_; }

 private:
  std::string code_;
};

/// Ends a verb whose computation did not converge.
class NotConverged : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Ends a verb one of whose inputs is no longer what it was when the run began.
class InputChanged : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Ends a verb whose output cannot be written: path, reason and remedy.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The exit code that an exception stands for.
[[nodiscard]] ExitCode exit_code_of(const std::exception& error);

}  // namespace rigfit::apps
