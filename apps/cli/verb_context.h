// What every verb gets from the common options, and what it leaves behind besides its result.
#pragma once

#include <cstdint>
#include <exception>
#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>

#include "apps/cli/warning_lines.h"
#include "signal/readers/recording_description.h"

namespace rigfit::apps {

using Json = nlohmann::ordered_json;

// How a run ended, as scripts see it, and the exceptions by which a verb ends early.

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

struct PlotSheet;  // apps/cli/plots/plot_option.h
struct AtHand;     // apps/campaign_file/recordings.h

/// A file read by a run, as it was when the run met it.
struct Input {
  std::string path;
  std::string sha256;                      ///< empty: could not be read then
  std::filesystem::file_time_type time{};  ///< of the last change
};

/// SHA-256 (FIPS 180-4) by OpenSSL, 64 lower-case hexadecimal digits.
[[nodiscard]] std::string sha256(std::string_view bytes);
/// Empty for what is no regular file or cannot be read: whoever reads it says why.
[[nodiscard]] std::string sha256_of_file(const std::filesystem::path& path);

// Files written whole or not at all (output_file.cc).

/// Writes beside the target under a temporary name, flushes to disk, then renames. Links are
/// followed; a device or pipe is written through (a pipe's reader is waited for). Throws
/// OutputError with path, reason and remedy; a regular target is then as it was.
void write_whole_file(const std::filesystem::path& path, std::string_view content);

/// Creates the folder (and parents). Throws OutputError.
void make_output_folder(const std::filesystem::path& folder);

class VerbContext {
 public:
  explicit VerbContext(std::ostream& out_stream) : out(out_stream) {}
  /// Says the warnings, however the run ends.
  ~VerbContext() { say_warnings(); }
  VerbContext(const VerbContext&) = delete;
  VerbContext& operator=(const VerbContext&) = delete;

  std::ostream& out;  ///< for people; a sink when JSON goes to standard output or with --quiet
  bool quiet = false;
  bool verbose = false;  ///< every warning and the notes on standard error
  bool silent = false;   ///< nothing on standard error: the caller takes all from warnings()
  int threads = 1;
  std::uint64_t seed = 1;
  signal::ReadOptions reading;       ///< how recordings are read, by the command line
  bool hashes_inputs = true;         ///< false: their names are enough
  std::vector<std::string> command;  ///< as typed, for provenance

  ExitCode exit_code = ExitCode::done;
  AtHand* at_hand = nullptr;  ///< objects in place of files, of callers that have them; else null
  std::shared_ptr<PlotSheet> plots;  ///< figures of the run, where --plot asks for them; else null

  /// A finding of the document, a warning or a note by its code (warning_lines.h). Warnings are
  /// said on standard error at the end, unless quiet.
  void warn(const std::string& code, const std::string& message, const std::string& where = "") {
    tell({{code, message, where}});
  }
  /// A warning that also ends the run with exit code 4: part of what was asked cannot be had.
  void refuse(const std::string& code, const std::string& message, const std::string& where = "") {
    tell({{code, message, where, true}});
  }
  /// A warning that ends the run with exit code 5: it did not converge.
  void fail(const std::string& message, const std::string& where = "") {
    warn("not_converged", message, where);
  }
  /// What an analysis found: refused, failed ("not_converged") or warned of.
  void tell(const std::vector<Finding>& findings);
  /// Names a file as an input of this run, before it is read: hashed now, and again at the end if
  /// it was touched meanwhile.
  void input(const std::string& path);
  /// Throws InputChanged when the content of an input is not what it was.
  void check_inputs() const;
  /// A file of results, whole or not at all; none from inputs that changed.
  void write(const std::filesystem::path& path, std::string_view content) const;

  /// The document of a run: `{rigfit, command, inputs[], warnings[], notes[], error, ...result}`.
  /// `error`, `{exit_code, code, message, where}`, is there when the run ends with another exit
  /// code than 0: the first finding that refused or that says what did not converge. Non-finite
  /// numbers are null where it is written.
  [[nodiscard]] Json document(const std::string& verb, const Json& result) const;

  const std::vector<Finding>& warnings() const { return warnings_; }
  const std::vector<Finding>& notes() const { return notes_; }
  const std::vector<Input>& inputs() const { return inputs_; }

 private:
  void say_warnings() const;

  std::vector<Finding> warnings_, notes_;
  Finding ended_by_;             ///< the first finding that gave the run its exit code
  std::vector<Finding> unsaid_;  ///< warnings to be said at the end
  std::vector<Input> inputs_;
};

}  // namespace rigfit::apps
