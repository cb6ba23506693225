#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <string>
#include <system_error>
#include <thread>

#include "apps/cli/verb_context.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
using namespace std::chrono_literals;

namespace {

[[noreturn]] void cannot_write(const fs::path& path, int reason) {
  const char* remedy = reason == ENOSPC || reason == EDQUOT || reason == EFBIG
                           ? "free space there, or name another file"
                       : reason == ENOENT || reason == ENOTDIR ? "make its folder, or name another"
                       : reason == ENXIO || reason == EPIPE
                           ? "start the program that reads from it before this one"
                           : "name another file, or change its rights";
  throw OutputError("cannot write " + path.string() + ": " +
                    std::generic_category().message(reason) + "; " + remedy);
}

/// The file that a chain of links ends at, whether it is there or not.
fs::path target_of(fs::path path) {
  std::error_code error;
  (void)fs::status(path, error);
  if (error == std::errc::too_many_symbolic_link_levels) cannot_write(path, ELOOP);
  while (fs::is_symlink(path, error)) path = path.parent_path() / fs::read_symlink(path, error);
  return path;
}

/// 0, or why not all of it could be written.
int write_all(int file, std::string_view content) {
  while (!content.empty()) {
    const ssize_t n = ::write(file, content.data(), content.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    content.remove_prefix(static_cast<std::size_t>(n));
  }
  return 0;
}

/// Devices and pipes: into what is there.
void write_through(const fs::path& path, std::string_view content) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  int file = -1;
  while ((file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)) < 0) {
    // A pipe's reader has 10 s to come.
    if (errno != ENXIO || Clock::now() - begin > 10s) cannot_write(path, errno);
    std::this_thread::sleep_for(20ms);
  }
  ::fcntl(file, F_SETFL, 0);  // waits while a pipe is full
  auto* const before = std::signal(SIGPIPE, SIG_IGN);
  const int reason = write_all(file, content);
  std::signal(SIGPIPE, before);
  ::close(file);
  if (reason != 0) cannot_write(path, reason);
}

}  // namespace

void write_whole_file(const fs::path& named, std::string_view content) {
  const fs::path path = target_of(named);
  std::error_code none;
  const auto kind = fs::status(path, none).type();
  if (kind == fs::file_type::directory) cannot_write(path, EISDIR);
  if (kind != fs::file_type::regular && kind != fs::file_type::not_found &&
      kind != fs::file_type::none && kind != fs::file_type::unknown) {
    return write_through(path, content);
  }
  const fs::path temporary = path.string() + "." + std::to_string(::getpid()) + ".part";
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) cannot_write(path, errno);
  int reason = write_all(file, content);
  if (reason == 0 && ::fsync(file) != 0 && errno != EINVAL && errno != ENOTSUP) reason = errno;
  if (::close(file) != 0 && reason == 0) reason = errno;
  if (reason == 0 && ::rename(temporary.c_str(), path.c_str()) != 0) reason = errno;
  if (reason == 0) return;
  ::unlink(temporary.c_str());
  cannot_write(path, reason);
}

void make_output_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) cannot_write(folder, error.value());
}

}  // namespace rigfit::apps
