#include "signal/readers/files/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "signal/recording/recording_error.h"

namespace rigfit::signal {

MappedFile::MappedFile(const std::filesystem::path& path) {
  const auto fail = [&](const std::string& problem, const std::string& remedy) {
    throw file_error(path, problem, remedy);
  };
  // A pipe without a writer must not hang the run.
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) {
    fail(std::string("cannot be opened: ") + std::strerror(errno), "check the path and its rights");
  }
  struct stat status {};
  const bool is_file = ::fstat(file, &status) == 0 && S_ISREG(status.st_mode);
  size_ = is_file ? static_cast<std::size_t>(status.st_size) : 0;
  void* const mapped =
      size_ == 0 ? MAP_FAILED : ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file, 0);
  const int reason = errno;
  ::close(file);
  if (!is_file) fail("is not a file", "give the file of one recording");
  if (size_ == 0) fail("is empty", "record again or copy the file again");
  if (mapped == MAP_FAILED) {
    fail(std::string("cannot be read: ") + std::strerror(reason), "copy it to a local disk");
  }
  data_ = static_cast<char*>(mapped);
  ::madvise(data_, size_, MADV_SEQUENTIAL);
}

MappedFile::~MappedFile() {
  if (data_ != nullptr) ::munmap(data_, size_);
}

void MappedFile::release_before(std::size_t offset) const {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const std::size_t whole = std::min(offset, size_) / page * page;
  if (whole > 0) ::madvise(data_, whole, MADV_DONTNEED);
}

}  // namespace rigfit::signal
