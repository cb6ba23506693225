// The machine's Chromium, which turns a page into a picture: looked for on the PATH.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace rigfit::apps {

/// Chromium or a browser that takes its options; empty: none.
[[nodiscard]] std::string find_chromium();

/// Runs headless Chromium on a local file with further options, such as --screenshot=F. False when
/// it fails.
bool run_chromium(const std::string& chromium, const std::vector<std::string>& options,
                  const std::filesystem::path& page);

/// The word as one types it in a shell: quoted where it holds more than letters, digits and a few
/// signs.
[[nodiscard]] std::string shell_word(const std::string& word);

/// A folder of its own for what a run needs for a moment, removed with everything in it.
[[nodiscard]] std::shared_ptr<const std::filesystem::path> scratch_folder();

}  // namespace rigfit::apps
