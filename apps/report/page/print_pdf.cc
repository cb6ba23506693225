#include "apps/report/page/print_pdf.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>
#include <thread>
#include <vector>

namespace rigfit::apps {
namespace fs = std::filesystem;
namespace {

/// A path as a file: URL.
std::string url_of(const fs::path& path) {
  std::string url = "file://";
  for (const char c : fs::absolute(path).string()) {
    const bool plain = (std::isalnum(static_cast<unsigned char>(c)) != 0) ||
                       std::string_view("/-_.~").find(c) != std::string_view::npos;
    url += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return url;
}

/// Ends with the program or after the time allowed; true when it ended by itself with status 0.
bool finished(pid_t program) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  for (int status = 0;;) {
    const pid_t done = waitpid(program, &status, WNOHANG);
    if (done == program) return WIFEXITED(status) && WEXITSTATUS(status) == 0;
    if (done < 0 && errno != EINTR) return false;
    if (std::chrono::steady_clock::now() > end) {
      kill(-program, SIGKILL);
      waitpid(program, &status, 0);
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

/// Runs a program without a word of its own, in a process group of its own.
bool run(std::vector<std::string> command) {
  std::vector<char*> arguments;
  arguments.reserve(command.size() + 1);
  for (auto& word : command) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&attributes);
  for (const int stream : {0, 1, 2}) {
    posix_spawn_file_actions_addopen(&files, stream, "/dev/null", O_RDWR, 0);
  }
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  pid_t program = 0;
  const int error = posix_spawn(&program, command.front().c_str(), &files, &attributes,
                                arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  return error == 0 && finished(program);
}

}  // namespace

std::string find_browser() {
  const char* path = std::getenv("PATH");
  if (!path) return {};
  for (const char* name : {"chromium", "chromium-browser", "google-chrome", "google-chrome-stable",
                           "chrome", "microsoft-edge"}) {
    std::istringstream folders(path);
    for (std::string folder; std::getline(folders, folder, ':');) {
      const std::string file = (fs::path(folder.empty() ? "." : folder) / name).string();
      if (access(file.c_str(), X_OK) == 0 && !fs::is_directory(file)) return file;
    }
  }
  return {};
}

std::string print_pdf(const std::string& browser, const fs::path& page, const fs::path& pdf) {
  std::error_code error;
  // A profile of its own: a browser that is open already keeps its own.
  std::string profile = (fs::temp_directory_path(error) / "rigfit-print-XXXXXX").string();
  if (error || !mkdtemp(profile.data())) {
    return fmt::format("no temporary folder for the browser's profile: {}", std::strerror(errno));
  }
  const fs::path part = pdf.string() + ".part.pdf";
  std::vector<std::string> command{browser,
                                   "--headless=new",
                                   "--disable-gpu",
                                   "--no-first-run",
                                   "--disable-background-networking",
                                   "--disable-component-update",
                                   "--disable-sync",
                                   "--disable-extensions",
                                   "--disable-dev-shm-usage",
                                   "--user-data-dir=" + profile,
                                   "--no-pdf-header-footer",
                                   "--generate-pdf-document-outline",
                                   "--print-to-pdf=" + fs::absolute(part).string()};
  // Chromium refuses its sandbox to the superuser; the page is our own and has no network.
  if (geteuid() == 0) command.emplace_back("--no-sandbox");
  command.push_back(url_of(page));
  const bool ran = run(std::move(command));
  fs::remove_all(profile, error);
  char begin[5] = {};
  std::ifstream(part, std::ios::binary).read(begin, 5);
  if (!ran || std::string_view(begin, 5) != "%PDF-") {
    fs::remove(part, error);
    return fmt::format("{} did not print {}", browser, page.string());
  }
  fs::rename(part, pdf, error);
  return error ? fmt::format("{}: {}", pdf.string(), error.message()) : std::string();
}

}  // namespace rigfit::apps
