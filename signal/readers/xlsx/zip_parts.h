// The parts of a zip archive, such as a workbook, unpacked block by block by minizip: an archive
// that would unpack to more than a limit is refused before the memory is taken.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "signal/recording/recording_error.h"

namespace rigfit::signal {

class ZipParts {
 public:
  /// Throws RecordingError when the file is no whole zip archive.
  explicit ZipParts(const std::filesystem::path& path);

  [[nodiscard]] bool holds(const std::string& part) const;

  /// A small part of XML as it is. This and the next throw RecordingError for a part that is
  /// absent, damaged, encrypted or too large.
  [[nodiscard]] std::string whole(const std::string& part);

  /// Calls `take` with pieces of XML that each hold whole elements of this name (without its
  /// namespace), one behind the other. Returns what stands behind the last of them.
  [[nodiscard]] std::string in_pieces(const std::string& part, const std::string& element,
                                      const std::function<void(std::string_view)>& take);

  /// The refusal of a part that is not as the format says.
  [[nodiscard]] RecordingError damaged(const std::string& part) const;

 private:
  void unpack(const std::string& part, const std::function<void(std::string_view)>& take);
  [[nodiscard]] RecordingError too_large(const std::string& part) const;

  std::string file_;
  std::unique_ptr<void, int (*)(void*)> zip_;
  std::size_t unpacked_ = 0;  ///< bytes, of all parts so far
};

}  // namespace rigfit::signal
