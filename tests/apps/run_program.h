// Runs the program as a person does: a command line in, exit code and what it wrote out.
#pragma once

#include <sys/types.h>

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tests/temporary_folder.h"

namespace rigfit::apps {
using testing::TemporaryFolder;

struct ProgramRun {
  int exit_code = -1;  ///< -1: ended by a signal
  std::string out, err;
};

/// Starts the program with these arguments; what it writes goes to "out" and "err" in a folder.
[[nodiscard]] pid_t start_program(const std::vector<std::string>& arguments,
                                  const TemporaryFolder& folder);

/// Arguments after the program's name, passed as they are (no shell).
[[nodiscard]] ProgramRun run_program(const std::vector<std::string>& arguments);

/// The same from one line: words apart by blanks, 'a word in quotes' may have some, $ at its
/// beginning is the folder of testdata, and each {} the next of `values`.
[[nodiscard]] ProgramRun run_line(const std::string& line,
                                  const std::vector<std::string>& values = {});

/// What a program wrote as JSON; is_discarded() when it is none.
[[nodiscard]] nlohmann::json parsed(const std::string& text);

/// The document of such a line with `--json -`; anything but exit code 0 fails the test, and
/// a result that is not as `rigfit help schema` says.
[[nodiscard]] nlohmann::json document_of(const std::string& line,
                                         const std::vector<std::string>& values = {});

/// The columns of a table of numbers behind a line of titles.
[[nodiscard]] std::vector<std::vector<double>> columns(const std::string& csv, std::string* header);

}  // namespace rigfit::apps
