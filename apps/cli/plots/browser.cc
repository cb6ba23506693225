#include "apps/cli/plots/browser.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <string_view>
#include <system_error>

namespace rigfit::apps {
namespace fs = std::filesystem;

std::string shell_word(const std::string& word) {
  const bool plain = std::ranges::all_of(word, [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view("-_./=,:+@%").find(c) != std::string::npos;
  });
  if (plain && !word.empty()) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string find_chromium() {
  for (const char* name : {"chromium", "chromium-browser", "google-chrome", "google-chrome-stable",
                           "chrome", "microsoft-edge"}) {
    const std::string look = fmt::format("command -v {} >/dev/null 2>&1", name);
    if (std::system(look.c_str()) == 0) return name;
  }
  return {};
}

bool run_chromium(const std::string& chromium, const std::vector<std::string>& options,
                  const fs::path& page) {
  const auto profile = scratch_folder();
  std::string command = chromium +
                        " --headless --disable-gpu --no-first-run --disable-extensions"
                        " --hide-scrollbars " +
                        shell_word("--user-data-dir=" + profile->string());
  if (::geteuid() == 0) command += " --no-sandbox";  // it refuses to run as root else
  for (const auto& option : options) command += " " + shell_word(option);
  command += " " + shell_word("file://" + fs::absolute(page).string());
  return std::system((command + " </dev/null >/dev/null 2>&1").c_str()) == 0;
}

std::shared_ptr<const fs::path> scratch_folder() {
  std::string name = (fs::temp_directory_path() / "rigfit-XXXXXX").string();
  if (!::mkdtemp(name.data())) {
    throw std::system_error(errno, std::generic_category(), "a temporary folder: " + name);
  }
  return {new fs::path(name), [](const fs::path* folder) {
            std::error_code none;
            fs::remove_all(*folder, none);
            delete folder;
          }};
}

}  // namespace rigfit::apps
