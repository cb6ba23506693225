#include "apps/report/stage_cache.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <system_error>

namespace rigfit::apps {
namespace fs = std::filesystem;
namespace {

/// What tells one build of the program from another: every build writes the file anew.
std::string program_identity() {
  struct stat file {};
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error || ::stat(program.c_str(), &file) != 0) return "";
  return fmt::format("{} {} {} {} {}", RIGFIT_VERSION, file.st_size, file.st_mtim.tv_sec,
                     file.st_mtim.tv_nsec, file.st_ino);
}

}  // namespace

StageCache::StageCache(fs::path folder)
    : folder_(std::move(folder)), program_(program_identity() + "\n") {}

std::optional<std::string> StageCache::read(const std::string& name) {
  {
    const std::lock_guard lock(mutex_);
    used_.insert(name);
  }
  std::ifstream file(folder_ / name, std::ios::binary);
  if (!file) return std::nullopt;
  std::string all(std::istreambuf_iterator<char>(file), {});
  // 64 digits of the hash of what follows.
  if (all.size() < 64 || sha256(std::string_view(all).substr(64)) != all.substr(0, 64)) {
    return std::nullopt;
  }
  return all.substr(64);
}

void StageCache::write(const std::string& name, const std::string& bytes) {
  if (program_ == "\n") return;  // builds cannot be told apart: keep nothing
  std::error_code error;
  fs::create_directories(folder_, error);
  const fs::path part = folder_ / fmt::format("{}.{}.part", name, ::getpid());
  std::ofstream file(part, std::ios::binary);
  file << sha256(bytes) << bytes;
  file.close();
  // A report without kept results is a report all the same.
  if (!file) {
    fs::remove(part, error);
  } else {
    fs::rename(part, folder_ / name, error);
  }
}

void StageCache::prune() const {
  std::error_code error;
  for (fs::directory_iterator entry(folder_, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    // Only what looks like ours: 64 hexadecimal digits.
    if (name.size() != 64 || name.find_first_not_of("0123456789abcdef") != std::string::npos) {
      continue;
    }
    std::error_code ignored;
    if (!used_.contains(name)) fs::remove(entry->path(), ignored);
  }
}

}  // namespace rigfit::apps
