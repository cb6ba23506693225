#include "signal/readers/arrays/mat_headers.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

#include "signal/readers/files/mapped_file.h"
#include "signal/recording/recording_error.h"

namespace rigfit::signal {
namespace {
using namespace std::string_view_literals;

// Types of elements and classes of arrays (MAT-File Format, The MathWorks, version 5).
constexpr std::uint32_t kInt8 = 1, kInt32 = 5, kUint32 = 6, kMatrix = 14, kCompressed = 15;
constexpr std::uint32_t kCell = 1, kStruct = 2, kObject = 3, kFunction = 16, kOpaque = 17;
constexpr std::size_t kTagBytes = 8, kMostDimensions = 32;
constexpr int kDeepestHeader = 64;
constexpr std::size_t kMostUnpacked = 1032;  // deflate packs at most so many to one (zlib's manual)
constexpr std::size_t kHead = 1 << 16;       // bytes of a packed variable that hold a header

std::size_t product(std::size_t a, std::size_t b) {
  constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max();
  return b != 0 && a > kMost / b ? kMost : a * b;
}

/// The first `most` bytes of what `packed` unpacks to; `whole`: all that it holds.
std::string unpacked(std::string_view packed, std::size_t most, bool& whole) {
  std::string out;
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return out;
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  int state = Z_OK;
  while (state == Z_OK && out.size() < most) {
    const std::size_t had = out.size(), piece = std::min(most - had, std::max(had, kHead));
    out.resize(had + piece);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + had);
    stream.avail_out = static_cast<uInt>(piece);
    state = inflate(&stream, Z_NO_FLUSH);
    out.resize(had + piece - stream.avail_out);
  }
  whole = state == Z_STREAM_END;
  inflateEnd(&stream);
  return out;
}

/// Walks the elements of a file or of a variable. A variable's own bytes may lack its end where
/// only its header is asked for.
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

  /// Whether a variable can hold what its header states. `stated`: its bytes; `whole`: they are all
  /// here. `has_elements`: it is made of variables, which are looked at where it is whole.
  [[nodiscard]] bool variable(std::size_t stated, bool whole, int depth, bool& has_elements) {
    if (stated == 0) return depth > 0;  // an empty element
    if (depth > kDeepestHeader) return false;
    Element flags, part;
    if (!next_of(kUint32, flags) || flags.data.size() != 8) return false;
    const std::uint32_t array_class = word(flags.data, 0) & 0xffU;
    if (array_class == kOpaque) return true;  // without dimensions
    if (!next_of(kInt32, part) || part.data.size() > 4 * kMostDimensions) return false;
    std::size_t count = 1;
    for (std::size_t d = 0; d < part.data.size() / 4; ++d) {
      count = product(count, word(part.data, d));
    }
    if (!next_of(kInt8, part)) return false;  // name
    const bool has_fields = array_class == kStruct || array_class == kObject;
    has_elements = has_fields || array_class == kCell;
    const std::size_t held = stated - std::min(stated, flags.stated + part.stated + 3 * kTagBytes);
    if (array_class == kFunction) return product(count, kTagBytes) <= held;
    if (!has_elements || !whole) return true;
    if (array_class == kObject && !next_of(kInt8, part)) return false;  // name of its class
    if (has_fields) {
      if (!next_of(kInt32, part) || part.data.size() != 4) return false;
      const std::size_t length = word(part.data, 0);  // a field's name has so many bytes
      if (length == 0 || !next_of(kInt8, part)) return false;
      count = product(count, part.data.size() / length);
    }
    if (product(count, kTagBytes) > rest_.size()) return false;
    while (rest_.size() >= kTagBytes) {
      if (!next(part) || !part.is_whole) return false;
      bool ignored = false;
      if (part.type == kMatrix &&
          !MatWalk(part.data, swapped_).variable(part.stated, true, depth + 1, ignored)) {
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
  bool has_elements = false;
  if (element.type == kMatrix) {
    return MatWalk(element.data, swapped).variable(element.stated, true, 0, has_elements);
  }
  if (element.type != kCompressed) return true;
  for (const std::size_t most : {kHead, std::numeric_limits<std::size_t>::max()}) {
    bool whole = false;
    const std::string text = unpacked(element.data, most, whole);
    MatWalk walk(text, swapped);
    MatWalk::Element variable;
    if (!walk.next(variable) || variable.type != kMatrix ||
        variable.stated > product(element.data.size(), kMostUnpacked) ||
        (whole && !variable.is_whole) ||
        !MatWalk(variable.data, swapped).variable(variable.stated, whole, 0, has_elements)) {
      return false;
    }
    if (whole || !has_elements) return true;
    if (text.size() < most) return false;  // breaks off
  }
  return true;
}

}  // namespace

void check_mat_headers(const std::filesystem::path& path) {
  const auto refusal = [&](const std::string& problem, const char* remedy) {
    return RecordingError({path.string(), 0, 0, "", ""}, problem, remedy);
  };
  const MappedFile file(path);
  const std::string_view header = file.bytes().substr(0, 128);
  const auto version = header.size() == 128 ? header.substr(124) : ""sv;
  if (version == "\0\2IM"sv || version == "\2\0MI"sv) return;  // HDF5: version 7.3
  const bool swapped = version == "\1\0MI"sv;
  if (!swapped && version != "\0\1IM"sv) {
    throw refusal("is no MATLAB file of version 5 to 7.3", "save it again, by save(F, '-v7')");
  }
  MatWalk walk(file.bytes().substr(128), swapped);
  MatWalk::Element element;
  for (std::size_t held = walk.rest().size(); walk.next(element); held = walk.rest().size()) {
    held -= kTagBytes;
    if (!element.is_whole) {
      throw refusal(fmt::format("breaks off: its last variable states {} bytes, of which {} are "
                                "missing",
                                element.stated, element.stated - held),
                    "copy the file again");
    }
    if (!can_be_held(element, swapped)) {
      throw refusal("breaks off, or states more elements than it can hold", "copy the file again");
    }
  }
}

}  // namespace rigfit::signal
