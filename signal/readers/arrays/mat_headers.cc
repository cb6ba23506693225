#include "signal/readers/arrays/mat_headers.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <limits>
#include <string_view>
#include <system_error>
#include <vector>

#include "signal/recording/recording_error.h"

namespace rigfit::signal {
namespace {
using namespace std::string_view_literals;

// Types of elements and classes of arrays (MAT-File Format, The MathWorks, version 5).
constexpr std::uint32_t kInt8 = 1, kInt32 = 5, kUint32 = 6, kMatrix = 14, kCompressed = 15;
constexpr std::uint32_t kCell = 1, kStruct = 2, kObject = 3, kFunction = 16, kOpaque = 17;
constexpr std::uint64_t kTagBytes = 8;
constexpr std::uint64_t kMostDimensions = 32;
constexpr int kDeepestHeader = 64;
// Deflate packs at most 1032 to one (zlib's manual).
constexpr std::uint64_t kMostUnpacked = 1032;

/// Bytes of a file, or of a packed variable in it.
class MatBytes {
 public:
  explicit MatBytes(std::ifstream& file) : file_(file) {}
  MatBytes(std::ifstream& file, std::uint64_t packed) : file_(file), packed_left_(packed) {
    is_open_ = inflateInit(&stream_) == Z_OK;
    is_packed_ = true;
  }
  MatBytes(const MatBytes&) = delete;
  MatBytes& operator=(const MatBytes&) = delete;
  ~MatBytes() {
    if (is_open_) inflateEnd(&stream_);
  }

  [[nodiscard]] bool read(void* to, std::size_t bytes) {
    if (!is_packed_)
      return static_cast<bool>(
          file_.read(static_cast<char*>(to), static_cast<std::streamsize>(bytes)));
    stream_.next_out = static_cast<Bytef*>(to);
    stream_.avail_out = static_cast<uInt>(bytes);
    while (is_open_ && stream_.avail_out > 0) {
      if (stream_.avail_in == 0) {
        const auto piece =
            static_cast<std::streamsize>(std::min<std::uint64_t>(packed_left_, input_.size()));
        if (piece == 0 || !file_.read(input_.data(), piece)) return false;
        packed_left_ -= static_cast<std::uint64_t>(piece);
        stream_.next_in = reinterpret_cast<Bytef*>(input_.data());
        stream_.avail_in = static_cast<uInt>(piece);
      }
      const int state = inflate(&stream_, Z_NO_FLUSH);
      if (state != Z_OK && !(state == Z_STREAM_END && stream_.avail_out == 0)) return false;
    }
    return is_open_;
  }

  [[nodiscard]] bool skip(std::uint64_t bytes) {
    if (!is_packed_) {
      file_.seekg(static_cast<std::streamoff>(bytes), std::ios::cur);
      return static_cast<bool>(file_);
    }
    std::array<char, 4096> unread{};
    for (; bytes > 0; bytes -= std::min<std::uint64_t>(bytes, unread.size())) {
      if (!read(unread.data(), std::min<std::uint64_t>(bytes, unread.size()))) return false;
    }
    return true;
  }

 private:
  std::ifstream& file_;
  bool is_packed_ = false, is_open_ = false;
  std::uint64_t packed_left_ = 0;
  std::vector<char> input_ = std::vector<char>(1 << 14);
  z_stream stream_{};
};

struct Tag {
  std::uint32_t type = 0;
  std::uint64_t bytes = 0;     ///< bytes of data
  std::uint64_t behind = 0;    ///< bytes of data and padding behind the tag
  std::uint32_t in_place = 0;  ///< up to four bytes of data that stand in the tag itself
};

std::uint64_t product(std::uint64_t a, std::uint64_t b) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();
  return b != 0 && a > kMost / b ? kMost : a * b;
}

/// Walks the elements of a file or of a packed variable.
class MatWalk {
 public:
  MatWalk(MatBytes& bytes, bool swapped) : bytes_(bytes), swapped_(swapped) {}

  /// The next tag; false: there is none.
  [[nodiscard]] bool tag(Tag& tag) {
    std::array<std::uint32_t, 2> words{};
    if (!bytes_.read(words.data(), kTagBytes)) return false;
    const std::uint32_t first = word(words[0]);
    if (first >> 16 != 0) {
      tag = {first & 0xffffU, first >> 16, 0, word(words[1])};
      return tag.bytes <= 4;
    }
    const std::uint64_t bytes = word(words[1]);
    const bool is_padded = first != kMatrix && first != kCompressed;
    tag = {first, bytes, is_padded ? (bytes + 7) / 8 * 8 : bytes, 0};
    return true;
  }

  /// A variable of `left` bytes behind its tag.
  [[nodiscard]] bool variable(std::uint64_t left, int depth) {
    if (left == 0) return depth > 0;  // an empty element
    if (depth > kDeepestHeader) return false;
    Words words{};
    std::uint64_t bytes = 0;
    if (!read_part(kUint32, left, words, bytes) || bytes != 8) return false;  // flags
    const std::uint32_t array_class = word(words[0]) & 0xffU;
    if (array_class == kOpaque) return depth == 0 || bytes_.skip(left);  // without dimensions
    if (!read_part(kInt32, left, words, bytes)) return false;            // dimensions
    std::uint64_t count = 1;
    for (std::uint64_t d = 0; d < bytes / 4; ++d) count = product(count, word(words[d]));
    if (!skip_part(kInt8, left, bytes)) return false;  // name
    const bool has_fields = array_class == kStruct || array_class == kObject;
    if (array_class == kFunction && product(count, kTagBytes) > left) return false;
    // Behind a variable of the file nothing more is asked for.
    if (!has_fields && array_class != kCell) return depth == 0 || bytes_.skip(left);
    if (array_class == kObject && !skip_part(kInt8, left, bytes))
      return false;  // name of its class
    if (has_fields) {
      if (!read_part(kInt32, left, words, bytes) || bytes != 4 || words[0] == 0) return false;
      const std::uint64_t length = word(words[0]);  // length of a field's name
      if (!skip_part(kInt8, left, bytes)) return false;
      count = product(count, bytes / length);
    }
    if (product(count, kTagBytes) > left) return false;
    while (left >= kTagBytes) {
      Tag element;
      if (!next(left, element)) return false;
      if (element.type == kMatrix ? !variable(element.bytes, depth + 1)
                                  : !bytes_.skip(element.behind)) {
        return false;
      }
    }
    return bytes_.skip(left);
  }

 private:
  using Words = std::array<std::uint32_t, kMostDimensions>;

  [[nodiscard]] std::uint32_t word(std::uint32_t value) const {
    return swapped_ ? __builtin_bswap32(value) : value;
  }

  /// The tag of the next part of a variable; `left` goes down by all of the part.
  [[nodiscard]] bool next(std::uint64_t& left, Tag& part) {
    if (left < kTagBytes || !tag(part) || part.behind > left - kTagBytes) return false;
    left -= kTagBytes + part.behind;
    return true;
  }

  [[nodiscard]] bool skip_part(std::uint32_t type, std::uint64_t& left, std::uint64_t& bytes) {
    Tag part;
    if (!next(left, part) || part.type != type) return false;
    bytes = part.bytes;
    return bytes_.skip(part.behind);
  }

  /// The words of a short part, in the order of bytes of the file.
  [[nodiscard]] bool read_part(std::uint32_t type, std::uint64_t& left, Words& words,
                               std::uint64_t& bytes) {
    Tag part;
    if (!next(left, part) || part.type != type || part.behind > sizeof(words)) return false;
    bytes = part.bytes;
    words[0] = word(part.in_place);  // back to the file's order
    return part.behind == 0 || bytes_.read(words.data(), part.behind);
  }

  MatBytes& bytes_;
  bool swapped_;
};

}  // namespace

void check_mat_headers(const std::filesystem::path& path) {
  const auto refuse = [&](const char* problem, const char* remedy) {
    throw RecordingError({path.string(), 0, 0, "", ""}, problem, remedy);
  };
  std::ifstream file(path, std::ios::binary);
  std::array<char, 128> header{};
  const bool is_whole = static_cast<bool>(file.read(header.data(), header.size()));
  const std::string_view version(header.data() + 124, 4);
  const bool swapped = version == "\1\0MI"sv;
  if (is_whole && (version == "\0\2IM"sv || version == "\2\0MI"sv)) return;  // HDF5: version 7.3
  if (!is_whole || (!swapped && version != "\0\1IM"sv)) {
    refuse("is no MATLAB file of version 5 to 7.3", "save it again, by save(F, '-v7')");
  }
  MatBytes bytes(file);
  MatWalk walk(bytes, swapped);
  Tag element;
  std::error_code none;
  const auto size = static_cast<std::uint64_t>(std::filesystem::file_size(path, none));
  while (walk.tag(element)) {
    const std::streamoff start = file.tellg();
    if (const std::uint64_t held = size - static_cast<std::uint64_t>(start);
        !none && element.behind > held) {
      throw RecordingError({path.string(), 0, 0, "", ""},
                           "breaks off: its last variable states " +
                               std::to_string(element.behind) + " bytes, of which " +
                               std::to_string(element.behind - held) + " are missing",
                           "copy the file again");
    }
    bool holds = element.type != kMatrix || walk.variable(element.bytes, 0);
    if (element.type == kCompressed) {
      MatBytes unpacked(file, element.bytes);
      MatWalk inside(unpacked, swapped);
      Tag variable;
      holds = inside.tag(variable) && variable.type == kMatrix &&
              variable.bytes <= product(element.bytes, kMostUnpacked) &&
              inside.variable(variable.bytes, 0);
    }
    if (!holds) {
      refuse("breaks off, or states more elements than it can hold", "copy the file again");
    }
    file.clear();
    file.seekg(start + static_cast<std::streamoff>(element.behind));
  }
}

}  // namespace rigfit::signal
