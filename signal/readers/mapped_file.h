// A file's bytes for a reader, mapped rather than copied, so that a 1 GB recording takes no extra
// memory.
#pragma once

#include <filesystem>
#include <string_view>

namespace rigfit::signal {

class MappedFile {
 public:
  /// Throws RecordingError when the file cannot be opened, is a folder, or is empty.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  [[nodiscard]] std::string_view bytes() const { return {data_, size_}; }

 private:
  char* data_ = nullptr;
  std::size_t size_ = 0;
};

/// Throws RecordingError for the files of other programs: what they are, how to export text.
void refuse_foreign(std::string_view bytes, const std::filesystem::path& path);

}  // namespace rigfit::signal
