#include "signal/readers/files/read_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "signal/readers/arrays/array_columns.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

/// What the dictionary says that numpy.save writes: {'descr': '<f8', 'fortran_order': False,
/// 'shape': (3, 2), }.
struct Header {
  char kind = 'f';  ///< f, i, u, b
  std::size_t size = 8;
  bool swapped = false;
  bool fortran = false;
  std::vector<std::size_t> shape;
};

Header parse_header(const std::string& text, const std::string& file) {
  static const std::regex kType(R"('descr'\s*:\s*'([^']*)')"),
      kNumber("([<>|=])(?:(f)([48])|([iu])([1248])|(b)(1))"),
      kOrder(R"('fortran_order'\s*:\s*True)"), kShape(R"('shape'\s*:\s*\(([0-9, ]*)\))"),
      kSize("[0-9]+");
  const auto refusal = [&](const std::string& value, std::string problem) {
    return RecordingError({file, 0, 0, "", to_utf8(value.substr(0, 60))}, std::move(problem),
                          "save an array of numbers with numpy.save");
  };
  std::smatch found;
  if (!std::regex_search(text, found, kType)) {
    throw refusal("descr", "holds records, or its header is damaged");
  }
  const std::string type = found[1];
  if (!std::regex_match(type, kNumber)) {
    const char letter = type.size() > 1 ? type[1] : ' ';
    throw refusal(type, letter == 'c'   ? "complex numbers: FRFs or spectra, no recording over time"
                        : letter == 'O' ? "Python objects, which only Python reads"
                                        : "numbers of a kind that is not read");
  }
  constexpr bool kBig = std::endian::native == std::endian::big;
  Header header{type[1],
                static_cast<std::size_t>(type[2] - '0'),
                type[0] == (kBig ? '<' : '>'),
                std::regex_search(text, kOrder),
                {}};
  if (!std::regex_search(text, found, kShape)) throw refusal("shape", "the header is damaged");
  const std::string sizes = found[1];
  for (std::sregex_iterator one(sizes.begin(), sizes.end(), kSize), end; one != end; ++one) {
    const std::string digits = one->str();
    header.shape.push_back(0);
    const auto error =
        std::from_chars(digits.data(), digits.data() + digits.size(), header.shape.back()).ec;
    if (error != std::errc()) throw refusal("shape", "the header is damaged");
  }
  return header;
}

std::string text_of(const std::vector<std::size_t>& shape) {
  std::string text;
  for (const std::size_t n : shape) text += (text.empty() ? "" : " x ") + std::to_string(n);
  return text;
}

}  // namespace

Recording read_npy(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options) {
  const std::string file = path.string();
  const auto byte = [&](std::size_t at) -> std::size_t {
    return static_cast<unsigned char>(bytes[at]);
  };
  if (bytes.size() < 12 || bytes.substr(0, 6) != "\x93NUMPY") {
    throw file_error(file, "is no NumPy array", "save it with numpy.save");
  }
  const bool long_header = byte(6) >= 2;
  const std::size_t begin = long_header ? 12 : 10;
  std::size_t length = byte(8) | byte(9) << 8;
  if (long_header) length |= byte(10) << 16 | byte(11) << 24;
  if (length > bytes.size() - begin) {
    throw file_error(file, "breaks off inside its header", "copy the file again");
  }
  constexpr std::size_t kLongestHeader = 1 << 13;  // enough for a hundred named fields
  const std::string dictionary(bytes.substr(begin, std::min(length, kLongestHeader)));
  const Header header = parse_header(dictionary, file);
  const std::string_view data = bytes.substr(begin + length);
  const std::size_t item = header.size;
  std::size_t items = 1;
  for (const std::size_t n : header.shape) {
    if (n > 0 && items > data.size() / n) items = data.size() + 1;  // more than can be there
    items = n == 0 ? 0 : (items > data.size() ? items : items * n);
  }
  if (items == 0 || header.shape.empty())
    throw file_error(file, "holds no samples", "record again");
  if (items > data.size() / item) {
    throw file_error(file,
                     fmt::format("states an array of {}, {} bytes each, but holds {} bytes",
                                 text_of(header.shape), item, data.size()),
                     "copy the file again");
  }
  if (header.shape.size() > 2) {
    throw file_error(file, "holds an array of " + text_of(header.shape),
                     "save one with samples and channels only (two dimensions)");
  }
  std::vector<Note> notes;
  const auto rows = static_cast<Eigen::Index>(header.shape[0]);
  const auto cols = static_cast<Eigen::Index>(header.shape.size() > 1 ? header.shape[1] : 1);
  std::string numbers(data.substr(0, items * item));  // aligned
  for (std::size_t at = 0; header.swapped && at < numbers.size(); at += item) {
    std::reverse(numbers.data() + at, numbers.data() + at + item);
  }
  Eigen::MatrixXd values;
  const auto take = [&](char kind, auto number) {
    if (header.kind != kind || item != sizeof number) return;
    values = matrix_of<decltype(number)>(numbers.data(), header.fortran ? rows : cols,
                                         header.fortran ? cols : rows);
  };
  take('f', float{});
  take('f', double{});
  take('i', std::int8_t{});
  take('i', std::int16_t{});
  take('i', std::int32_t{});
  take('i', std::int64_t{});
  take('u', std::uint8_t{});
  take('u', std::uint16_t{});
  take('u', std::uint32_t{});
  take('u', std::uint64_t{});
  take('b', std::uint8_t{});
  if (!header.fortran) values.transposeInPlace();
  auto columns = columns_of(values, "", header.kind == 'f' && item == 4, notes);
  return recording_of_columns(std::move(columns), path, "npy", options, 0, std::move(notes));
}

}  // namespace rigfit::signal
