// Runs the program as a person does: a command line in, exit code and what it wrote out.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace rigfit::apps {

struct ProgramRun {
  int exit_code = -1;  ///< -1: ended by a signal
  std::string out, err;
};

/// Arguments after the program's name, passed as they are (no shell).
[[nodiscard]] ProgramRun run_program(const std::vector<std::string>& arguments);

/// The same from one line: words apart by blanks, 'a word in quotes' may have some, $ at its
/// beginning is the folder of testdata, and each {} the next of `values`.
[[nodiscard]] ProgramRun run_line(const std::string& line,
                                  const std::vector<std::string>& values = {});

/// What a program wrote as JSON; is_discarded() when it is none.
[[nodiscard]] nlohmann::json parsed(const std::string& text);

/// The document of such a line with `--json -`; anything but exit code 0 fails the test.
[[nodiscard]] nlohmann::json document_of(const std::string& line,
                                         const std::vector<std::string>& values = {});

/// The columns of a table of numbers behind a line of titles.
[[nodiscard]] std::vector<std::vector<double>> columns(const std::string& csv, std::string* header);

/// A folder of this test's own, empty, removed with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// The path of a file in it.
  [[nodiscard]] std::string at(const std::string& name) const { return (path_ / name).string(); }
  /// Writes a file in it (folders as needed) and returns its path.
  std::string write(const std::string& name, const std::string& content) const;
  /// The content of a file in it; empty when there is none.
  [[nodiscard]] std::string read(const std::string& name) const;

 private:
  std::filesystem::path path_;
};

}  // namespace rigfit::apps
