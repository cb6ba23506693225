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

/// What a program wrote as JSON; is_discarded() when it is none.
[[nodiscard]] nlohmann::json parsed(const std::string& text);

/// A scene: a cable of 2.4 m in 12 segments between pinned ends at 200 N.
inline constexpr const char* kCableScene = R"([[node]]
name = "left"
position = [0.0, 0.0, 0.0]
support = "pinned"
[[node]]
name = "right"
position = [2.4, 0.0, 0.0]
support = "pinned"
[[member]]
name = "cable"
kind = "cable"
nodes = ["left", "right"]
segments = 12
mass_per_length = 0.16667
EA = 221780.0
EI = 0.5972
GJ = 0.1
tension = 200.0
)";

/// A folder of this test's own, empty, removed with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Writes a file in it (folders as needed) and returns its path.
  std::string write(const std::string& name, const std::string& content) const;
  /// The content of a file in it; empty when there is none.
  [[nodiscard]] std::string read(const std::string& name) const;

 private:
  std::filesystem::path path_;
};

}  // namespace rigfit::apps
