// The machine's Chromium, which turns a page into a picture: looked for on the PATH, run without a
// shell.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rigfit::apps {

/// Chromium or a browser that takes its options; empty: none.
[[nodiscard]] std::filesystem::path find_chromium();

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
