#include "signal/readers/files/read_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "signal/readers/arrays/array_columns.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

/// One kind of number: '<f8' ...
struct Field {
  std::string name;
  char kind = 'f';  ///< f, i, u, b
  std::size_t size = 8;
  bool swapped = false;
};

struct Header {
  std::vector<Field> fields;
  bool record = false;
  bool fortran = false;
  std::vector<std::size_t> shape;
};

/// The dictionary of Python that numpy.save writes: {'descr': '<f8', 'fortran_order': False,
/// 'shape': (3, 2), }; a structured array has a list of (name, type) as descr.
class HeaderParser {
 public:
  HeaderParser(const std::string& text, const std::string& file) : text_(text), file_(file) {}

  [[nodiscard]] Header parse() const {
    using Words = std::sregex_iterator;
    static const std::regex kOne(R"('descr'\s*:\s*'([^']*)')"), kList(R"('descr'\s*:\s*\[)"),
        kItem(R"x(\(\s*(?:'([^']*)'|"([^"]*)")\s*,\s*('([^']*)'|\[)\s*(,?))x"),
        kOrder(R"('fortran_order'\s*:\s*True)"), kShape(R"('shape'\s*:\s*\(([0-9, ]*)\))"),
        kSize("[0-9]+");
    Header header;
    std::smatch found;
    if (std::regex_search(text_, found, kOne)) {
      header.fields.push_back(field("", found[1]));
    } else if (std::regex_search(text_, found, kList)) {
      header.record = true;
      for (Words one(text_.begin(), text_.end(), kItem), end; one != end; ++one) {
        const std::string name = (*one)[1].matched ? (*one)[1] : (*one)[2];
        if (!(*one)[4].matched || (*one)[5].length() > 0) {
          throw refusal(name, "a field that is an array or a record itself, which is not read");
        }
        header.fields.push_back(field(name, (*one)[4]));
      }
    }
    if (header.fields.empty()) throw refusal("descr", "the header does not say what it holds");
    header.fortran = std::regex_search(text_, kOrder);
    if (!std::regex_search(text_, found, kShape)) throw refusal("shape", "the header is damaged");
    const std::string sizes = found[1];
    for (Words one(sizes.begin(), sizes.end(), kSize), end; one != end; ++one) {
      const std::string digits = one->str();
      std::size_t value = 0;
      const auto error = std::from_chars(digits.data(), digits.data() + digits.size(), value).ec;
      if (error != std::errc()) throw refusal("shape", "the header is damaged");
      header.shape.push_back(value);
    }
    return header;
  }

 private:
  [[nodiscard]] RecordingError refusal(const std::string& value, std::string problem) const {
    return {{file_, 0, 0, "", to_utf8(value.substr(0, 60))},
            std::move(problem),
            "save an array of numbers with numpy.save"};
  }
  [[nodiscard]] Field field(const std::string& name, const std::string& text) const {
    static const std::regex kNumber("([<>|=])(?:(f)([48])|([iu])([1248])|(b)(1))");
    std::smatch found;
    if (text.size() > 1 && text[1] == 'c') {
      throw refusal(text, "complex numbers: FRFs or spectra, no recording over time");
    }
    if (!std::regex_match(text, found, kNumber)) {
      throw refusal(text, text.size() > 1 && text[1] == 'O'
                              ? "Python objects, which only Python reads"
                              : "numbers of a kind that is not read");
    }
    Field result{name, text[1], static_cast<std::size_t>(text[2] - '0'), false};
    const char swapped = std::endian::native == std::endian::big ? '<' : '>';
    result.swapped = text[0] == swapped && result.size > 1;
    return result;
  }

  const std::string& text_;
  const std::string& file_;
};

template <typename Number>
double number_at(const char* p, bool swapped) {
  char buffer[sizeof(Number)];
  std::memcpy(buffer, p, sizeof buffer);
  if (swapped) std::reverse(buffer, buffer + sizeof buffer);
  Number value;
  std::memcpy(&value, buffer, sizeof value);
  return static_cast<double>(value);
}

double value_at(const char* p, const Field& field) {
  const bool s = field.swapped;
  if (field.kind == 'f') return field.size == 4 ? number_at<float>(p, s) : number_at<double>(p, s);
  const bool sign = field.kind == 'i';
  switch (field.size) {
    case 1:
      return sign ? number_at<std::int8_t>(p, s) : number_at<std::uint8_t>(p, s);
    case 2:
      return sign ? number_at<std::int16_t>(p, s) : number_at<std::uint16_t>(p, s);
    case 4:
      return sign ? number_at<std::int32_t>(p, s) : number_at<std::uint32_t>(p, s);
    default:
      return sign ? number_at<std::int64_t>(p, s) : number_at<std::uint64_t>(p, s);
  }
}

std::string text_of(const std::vector<std::size_t>& shape) {
  std::string text;
  for (const std::size_t n : shape) text += (text.empty() ? "" : " x ") + std::to_string(n);
  return text;
}

}  // namespace

Recording read_npy(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options, const std::function<void(std::size_t)>& done_with) {
  const std::string file = path.string();
  const auto refusal = [&](const std::string& problem, const std::string& remedy) {
    return RecordingError({file, 0, 0, "", ""}, problem, remedy);
  };
  const auto byte = [&](std::size_t at) -> std::size_t {
    return static_cast<unsigned char>(bytes[at]);
  };
  if (bytes.size() < 12 || bytes.substr(0, 6) != "\x93NUMPY") {
    throw refusal("is no NumPy array", "save it with numpy.save");
  }
  const bool long_header = byte(6) >= 2;
  const std::size_t begin = long_header ? 12 : 10;
  std::size_t length = byte(8) | byte(9) << 8;
  if (long_header) length |= byte(10) << 16 | byte(11) << 24;
  if (length > bytes.size() - begin) {
    throw refusal("breaks off inside its header", "copy the file again");
  }
  constexpr std::size_t kLongestHeader = 1 << 13;  // enough for a hundred named fields
  const std::string dictionary(bytes.substr(begin, std::min(length, kLongestHeader)));
  const Header header = HeaderParser(dictionary, file).parse();
  const std::string_view data = bytes.substr(begin + length);
  std::size_t item = 0, items = 1;
  for (const auto& field : header.fields) item += field.size;
  for (const std::size_t n : header.shape) {
    if (n > 0 && items > data.size() / n) items = data.size() + 1;  // more than can be there
    items = n == 0 ? 0 : (items > data.size() ? items : items * n);
  }
  if (items == 0 || header.shape.empty()) throw refusal("holds no samples", "record again");
  if (items > data.size() / item) {
    throw refusal(fmt::format("states an array of {}, {} bytes each, but holds {} bytes",
                              text_of(header.shape), item, data.size()),
                  "copy the file again");
  }
  if (header.shape.size() > 2 || (header.record && header.shape.size() > 1)) {
    throw refusal("holds an array of " + text_of(header.shape),
                  "save one with samples and channels only (two dimensions)");
  }
  std::vector<Note> notes;
  std::vector<ArrayColumn> columns;
  if (header.record) {
    std::size_t offset = 0;
    for (const auto& field : header.fields) {
      ArrayColumn column{field.name, Eigen::VectorXd(static_cast<Eigen::Index>(items)),
                         field.kind == 'f' && field.size == 4};
      for (std::size_t k = 0; k < items; ++k) {
        column.values[static_cast<Eigen::Index>(k)] =
            value_at(data.data() + k * item + offset, field);
      }
      offset += field.size;
      columns.push_back(std::move(column));
    }
  } else {
    const Field& field = header.fields.front();
    const auto rows = static_cast<Eigen::Index>(header.shape[0]);
    const auto cols = static_cast<Eigen::Index>(header.shape.size() > 1 ? header.shape[1] : 1);
    Eigen::MatrixXd values(rows, cols);
    constexpr Eigen::Index kRowsPerCall = Eigen::Index{1} << 18;
    for (Eigen::Index r = 0; r < rows; ++r) {
      if (done_with && !header.fortran && r % kRowsPerCall == kRowsPerCall - 1) {
        done_with(begin + length + static_cast<std::size_t>(r * cols) * item);
      }
      for (Eigen::Index c = 0; c < cols; ++c) {
        const Eigen::Index at = header.fortran ? c * rows + r : r * cols + c;
        values(r, c) = value_at(data.data() + static_cast<std::size_t>(at) * item, field);
      }
    }
    columns = columns_of(values, "", field.kind == 'f' && field.size == 4, notes);
  }
  return recording_of_columns(std::move(columns), path, "npy", options, 0, std::move(notes));
}

}  // namespace rigfit::signal
