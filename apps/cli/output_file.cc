#include "apps/cli/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <string>
#include <system_error>
#include <vector>

#include "apps/cli/exit_code.h"

namespace rigfit::apps {
namespace fs = std::filesystem;

void write_whole_file(const fs::path& path, std::string_view content) {
  const fs::path temporary = path.string() + "." + std::to_string(::getpid()) + ".part";
  const auto fail = [&](const char* what) {
    const int reason = errno;
    ::unlink(temporary.c_str());
    throw std::system_error(reason, std::generic_category(),
                            std::string(what) + " " + path.string());
  };
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) fail("cannot write");
  std::size_t written = 0;
  while (written < content.size()) {
    const ssize_t n = ::write(file, content.data() + written, content.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const int reason = errno;
      ::close(file);
      errno = reason;
      fail("cannot write");
    }
    written += static_cast<std::size_t>(n);
  }
  if (::fsync(file) != 0 && errno != EINVAL && errno != ENOTSUP) {
    const int reason = errno;
    ::close(file);
    errno = reason;
    fail("cannot write");
  }
  if (::close(file) != 0) fail("cannot write");
  if (::rename(temporary.c_str(), path.c_str()) != 0) fail("cannot put in place");
}

void sweep_parts(const fs::path& folder) {
  constexpr std::string_view kEnd = ".part";
  std::error_code error;
  std::vector<fs::path> left;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!name.ends_with(kEnd)) continue;
    const std::string stem = name.substr(0, name.size() - kEnd.size());
    const auto dot = stem.rfind('.');
    if (dot == std::string::npos) continue;
    int writer = 0;
    const char* last = stem.data() + stem.size();
    const auto parsed = std::from_chars(stem.data() + dot + 1, last, writer);
    if (parsed.ec != std::errc() || parsed.ptr != last || writer <= 0) continue;
    if (::kill(writer, 0) != 0 && errno == ESRCH) left.push_back(entry->path());
  }
  for (const auto& path : left) fs::remove(path, error);
}

void make_output_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder)) {
    throw UsageError("cannot make the output folder " + folder.string() + ": " +
                     (error ? error.message() : "a file of that name exists") +
                     "; name another with --out");
  }
}

}  // namespace rigfit::apps
