#include <zlib.h>

#include <cstdint>
#include <cstring>

#include "signal/readers/csv_table.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {
namespace {

using namespace std::string_view_literals;

// Types of elements and classes of arrays (MAT-File Format, The MathWorks, version 5).
enum Type : std::uint32_t { int8 = 1, int32 = 5, uint32 = 6, matrix = 14, compressed = 15 };
enum Class : std::uint32_t {
  cell = 1,
  structure = 2,
  object = 3,
  numbers_from = 6,  // double
  numbers_to = 15,   // uint64
  function = 16,
  opaque = 17
};
constexpr std::size_t kTagBytes = 8;
constexpr int kDeepestHeader = 64;
constexpr std::size_t kPiece = 1 << 16;  // bytes unpacked at once

/// Bytes of a number of a type of elements.
std::size_t bytes_of(std::uint32_t type) {
  return type <= 2 ? 1 : type <= 4 ? 2 : type <= 7 ? 4 : 8;
}

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

/// An element of a file or of a variable.
struct Element {
  std::uint32_t type = 0;
  std::string_view data;  ///< without tag and padding
};

/// Reads the elements of a file's byte order.
class Elements {
 public:
  explicit Elements(bool swapped) : swapped_(swapped) {}

  /// Those that stand behind each other in `rest`; none where one of them breaks off.
  [[nodiscard]] std::vector<Element> in(std::string_view rest) const {
    std::vector<Element> found;
    while (rest.size() >= kTagBytes) {
      const std::uint32_t type = word(rest, 0);
      const std::size_t small = type >> 16;  // bytes of data in the tag itself, up to four
      const std::size_t size = small > 0 ? small : word(rest, 1);
      const bool is_padded = type != matrix && type != compressed;
      const std::size_t stated = small > 0 ? 0 : is_padded ? (size + 7) / 8 * 8 : size;
      if (small > 4 || stated > rest.size() - kTagBytes) return {};
      found.push_back({type & 0xffffU, rest.substr(small > 0 ? 4 : kTagBytes, size)});
      rest.remove_prefix(kTagBytes + stated);
    }
    return found;
  }

  /// Whether a variable, packed or not, can hold what its header states, and so can the variables
  /// that it is made of.
  [[nodiscard]] bool can_hold(const Element& variable, int depth = 0) const {
    if (variable.type == compressed) {
      const std::string text = unpacked(variable.data);
      const auto inside = in(text);
      return !inside.empty() && inside[0].type == matrix && can_hold(inside[0], depth);
    }
    if (variable.type != matrix) return true;
    if (variable.data.empty()) return depth > 0;
    const auto parts = in(variable.data);
    const auto is = [&](std::size_t k, std::uint32_t type) {
      return k < parts.size() && parts[k].type == type;
    };
    if (depth > kDeepestHeader || !is(0, uint32) || parts[0].data.size() != 8) return false;
    const std::uint32_t array_class = word(parts[0].data, 0) & 0xffU;
    if (array_class == opaque) return true;  // without dimensions
    const bool has_fields = array_class == structure || array_class == object;
    const bool has_size = is(1, int32) && parts[1].data.size() <= 128;  // 32 dimensions of 4 bytes
    if (!has_size || !is(2, int8)) return false;
    double count = 1;
    for (std::size_t d = 0; d < parts[1].data.size() / 4; ++d) count *= word(parts[1].data, d);
    if (array_class >= numbers_from && array_class <= numbers_to) {
      // Real parts, and where there are some the imaginary ones.
      return std::all_of(parts.begin() + 3, parts.end(), [&](const Element& part) {
        return count * static_cast<double>(bytes_of(part.type)) ==
               static_cast<double>(part.data.size());
      });
    }
    if (!has_fields && array_class != cell && array_class != function) return true;
    std::size_t first = 3;  // first of the parts that are variables
    if (array_class == object && !is(first++, int8)) return false;  // name of its class
    if (has_fields) {
      if (!is(first, int32) || parts[first].data.size() != 4 || !is(first + 1, int8)) return false;
      const std::size_t length = word(parts[first].data, 0);  // a field's name has so many bytes
      if (length == 0) return false;
      const std::size_t fields = parts[first + 1].data.size() / length;
      count *= static_cast<double>(fields);
      first += 2;
    }
    return count <= static_cast<double>(parts.size() - first) &&
           std::all_of(parts.begin() + static_cast<std::ptrdiff_t>(first), parts.end(),
                       [&](const Element& part) { return can_hold(part, depth + 1); });
  }

 private:
  [[nodiscard]] std::uint32_t word(std::string_view data, std::size_t k) const {
    std::uint32_t value = 0;
    std::memcpy(&value, data.data() + 4 * k, 4);
    return swapped_ ? __builtin_bswap32(value) : value;
  }

  bool swapped_;
};

}  // namespace

void check_mat_headers(std::string_view bytes, const std::filesystem::path& path) {
  const std::string_view header = bytes.substr(0, 128);
  const auto version = header.size() == 128 ? header.substr(124) : ""sv;
  if (version == "\0\2IM"sv || version == "\2\0MI"sv) return;  // HDF5: version 7.3
  const bool big_endian = version == "\1\0MI"sv;
  if (!big_endian && version != "\0\1IM"sv) {
    throw file_error(path, "is no MATLAB file of version 5 to 7.3",
                     "save it again, by save(F, '-v7')");
  }
  const Elements elements(is_swapped(big_endian));
  const auto variables = elements.in(bytes.substr(128));
  if (variables.empty() ||
      !std::ranges::all_of(variables, [&](const Element& one) { return elements.can_hold(one); })) {
    throw file_error(path, "breaks off, or states more elements than it can hold",
                     "copy the file again");
  }
}

}  // namespace rigfit::signal
