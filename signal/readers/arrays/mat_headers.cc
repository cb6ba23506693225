#include "signal/readers/arrays/array_columns.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "signal/recording/recording_error.h"

namespace rigfit::signal {
namespace {
using namespace std::string_view_literals;

// Types of elements and classes of arrays (MAT-File Format, The MathWorks, version 5).
constexpr std::uint32_t kInt8 = 1, kInt32 = 5, kUint32 = 6, kMatrix = 14, kCompressed = 15;
constexpr std::uint32_t kCell = 1, kStruct = 2, kObject = 3, kFunction = 16, kOpaque = 17;
constexpr std::size_t kTagBytes = 8, kMostDimensions = 32;
constexpr int kDeepestHeader = 64;
constexpr std::size_t kPiece = 1 << 16;  // bytes unpacked at once

/// What `packed` unpacks to; up to where it breaks off.
std::string unpacked(std::string_view packed) {
  std::string out;
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return out;
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  for (int state = Z_OK; state == Z_OK;) {
    const std::size_t had = out.size(), piece = std::max(had, kPiece);
    out.resize(had + piece);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + had);
    stream.avail_out = static_cast<uInt>(piece);
    state = inflate(&stream, Z_NO_FLUSH);
    out.resize(had + piece - stream.avail_out);
  }
  inflateEnd(&stream);
  return out;
}

/// Walks the elements of a file or of a variable.
class MatWalk {
 public:
  MatWalk(std::string_view bytes, bool swapped) : rest_(bytes), swapped_(swapped) {}

  struct Element {
    std::uint32_t type = 0;
    std::size_t stated = 0;  ///< bytes behind the tag, padding included
    bool is_whole = false;   ///< they are all there
    std::string_view data;   ///< without padding
  };

  [[nodiscard]] std::string_view rest() const { return rest_; }

  /// The next element; false: there is none, or its tag is damaged.
  [[nodiscard]] bool next(Element& element) {
    if (rest_.size() < kTagBytes) return false;
    const std::uint32_t first = word(rest_, 0);
    std::size_t bytes = word(rest_, 1);
    if (first >> 16 != 0) {  // up to four bytes of data in the tag itself
      bytes = first >> 16;
      element = {first & 0xffffU, 0, true, rest_.substr(4, bytes)};
      rest_.remove_prefix(kTagBytes);
      return bytes <= 4;
    }
    rest_.remove_prefix(kTagBytes);
    const bool is_padded = first != kMatrix && first != kCompressed;
    element.type = first;
    element.stated = is_padded ? (bytes + 7) / 8 * 8 : bytes;
    element.is_whole = element.stated <= rest_.size();
    element.data = rest_.substr(0, bytes);
    rest_.remove_prefix(std::min(element.stated, rest_.size()));
    return true;
  }

  /// Whether a variable can hold what its header states, and so can the variables that it is made
  /// of.
  [[nodiscard]] bool variable(int depth) {
    if (rest_.empty()) return depth > 0;  // an empty element
    if (depth > kDeepestHeader) return false;
    Element flags, part;
    if (!next_of(kUint32, flags) || flags.data.size() != 8) return false;
    const std::uint32_t array_class = word(flags.data, 0) & 0xffU;
    if (array_class == kOpaque) return true;  // without dimensions
    if (!next_of(kInt32, part) || part.data.size() > 4 * kMostDimensions) return false;
    double count = 1;
    for (std::size_t d = 0; d < part.data.size() / 4; ++d) count *= word(part.data, d);
    if (!next_of(kInt8, part)) return false;  // name
    const bool has_fields = array_class == kStruct || array_class == kObject;
    if (array_class == kFunction) return count * kTagBytes <= static_cast<double>(rest_.size());
    if (!has_fields && array_class != kCell) return true;
    if (array_class == kObject && !next_of(kInt8, part)) return false;  // name of its class
    if (has_fields) {
      if (!next_of(kInt32, part) || part.data.size() != 4) return false;
      const std::size_t length = word(part.data, 0);  // a field's name has so many bytes
      if (length == 0 || !next_of(kInt8, part)) return false;
      count *= static_cast<double>(part.data.size() / length);
    }
    if (count * kTagBytes > static_cast<double>(rest_.size())) return false;
    while (rest_.size() >= kTagBytes) {
      if (!next(part) || !part.is_whole) return false;
      if (part.type == kMatrix && !MatWalk(part.data, swapped_).variable(depth + 1)) {
        return false;
      }
    }
    return true;
  }

 private:
  [[nodiscard]] std::uint32_t word(std::string_view data, std::size_t k) const {
    std::uint32_t value = 0;
    std::memcpy(&value, data.data() + 4 * k, 4);
    return swapped_ ? __builtin_bswap32(value) : value;
  }
  /// The next element, which is of this type and whole.
  [[nodiscard]] bool next_of(std::uint32_t type, Element& element) {
    return next(element) && element.type == type && element.is_whole;
  }

  std::string_view rest_;
  bool swapped_;
};

bool can_be_held(const MatWalk::Element& element, bool swapped) {
  if (element.type == kCompressed) {
    const std::string text = unpacked(element.data);
    MatWalk walk(text, swapped);
    MatWalk::Element variable;
    return walk.next(variable) && variable.type == kMatrix && variable.is_whole &&
           can_be_held(variable, swapped);
  }
  return element.type != kMatrix || MatWalk(element.data, swapped).variable(0);
}

}  // namespace

void check_mat_headers(std::string_view bytes, const std::filesystem::path& path) {
  const std::string_view header = bytes.substr(0, 128);
  const auto version = header.size() == 128 ? header.substr(124) : ""sv;
  if (version == "\0\2IM"sv || version == "\2\0MI"sv) return;  // HDF5: version 7.3
  const bool swapped = version == "\1\0MI"sv;
  if (!swapped && version != "\0\1IM"sv) {
    throw file_error(path, "is no MATLAB file of version 5 to 7.3",
                     "save it again, by save(F, '-v7')");
  }
  MatWalk walk(bytes.substr(128), swapped);
  MatWalk::Element element;
  for (std::size_t held = walk.rest().size(); walk.next(element); held = walk.rest().size()) {
    held -= kTagBytes;
    if (!element.is_whole) {
      throw file_error(path,
                       fmt::format("breaks off: its last variable states {} bytes, of which {} are "
                                   "missing",
                                   element.stated, element.stated - held),
                       "copy the file again");
    }
    if (!can_be_held(element, swapped)) {
      throw file_error(path, "breaks off, or states more elements than it can hold",
                       "copy the file again");
    }
  }
}

}  // namespace rigfit::signal
