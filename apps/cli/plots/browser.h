// Programs of the machine that turn a page into a picture or show it: looked for on the PATH, run
// without a shell.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rigfit::apps {

/// The first of the names that is on the PATH and can be run; empty: none.
[[nodiscard]] std::filesystem::path find_program(const std::vector<std::string>& names);

/// Chromium or a browser that takes its options; empty: none.
[[nodiscard]] std::filesystem::path find_chromium();

/// Runs a program with arguments, silently, and waits for it: its exit code; -1 when it cannot be
/// started, 128 + signal when one ended it.
int run_silently(const std::filesystem::path& program, const std::vector<std::string>& arguments);

/// Runs headless Chromium on a local file with further options, such as --screenshot=F. False when
/// it fails.
bool run_chromium(const std::filesystem::path& chromium, const std::vector<std::string>& options,
                  const std::filesystem::path& page);

/// A folder of its own for what a run needs for a moment, removed with everything in it.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace rigfit::apps
