#include "apps/cli/plots/browser.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <sstream>
#include <system_error>

namespace rigfit::apps {
namespace fs = std::filesystem;

namespace {

/// Runs a program with arguments, silently, and waits for it: its exit code; -1 when it cannot be
/// started, 128 + signal when one ended it.
int run_silently(const fs::path& program, const std::vector<std::string>& arguments) {
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  if (::posix_spawn_file_actions_init(&actions) != 0) return -1;
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int started =
      ::posix_spawn(&child, program.c_str(), &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (started != 0) return -1;
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return -1;
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

fs::path find_chromium() {
  const char* path = std::getenv("PATH");
  for (const char* name : {"chromium", "chromium-browser", "google-chrome", "google-chrome-stable",
                           "chrome", "microsoft-edge"}) {
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
      fs::path file = fs::path(folder) / name;
      std::error_code error;
      if (fs::is_regular_file(file, error) && ::access(file.c_str(), X_OK) == 0) return file;
    }
  }
  return {};
}

bool run_chromium(const fs::path& chromium, const std::vector<std::string>& options,
                  const fs::path& page) {
  const ScratchFolder profile;
  std::vector<std::string> arguments{
      "--headless",           "--disable-gpu",     "--no-first-run",
      "--disable-extensions", "--hide-scrollbars", "--user-data-dir=" + profile.path().string()};
  if (::geteuid() == 0) arguments.emplace_back("--no-sandbox");  // it refuses to run as root else
  arguments.insert(arguments.end(), options.begin(), options.end());
  arguments.push_back("file://" + fs::absolute(page).string());
  return run_silently(chromium, arguments) == 0;
}

ScratchFolder::ScratchFolder() {
  std::string name = (fs::temp_directory_path() / "rigfit-XXXXXX").string();
  if (!::mkdtemp(name.data())) {
    throw std::system_error(errno, std::generic_category(), "a temporary folder: " + name);
  }
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code none;
  fs::remove_all(path_, none);
}

}  // namespace rigfit::apps
