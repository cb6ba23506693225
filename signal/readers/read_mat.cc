#include "signal/readers/read_recording.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "signal/readers/array_columns.h"
#include "signal/readers/csv_table.h"
#include "signal/readers/frequency_table.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/recording_time.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

using namespace std::string_view_literals;

// Types of elements and classes of arrays (MAT-File Format, The MathWorks, version 5).
constexpr std::uint32_t kInt8 = 1, kInt32 = 5, kUint32 = 6, kMatrix = 14, kCompressed = 15;
constexpr std::uint32_t kCell = 1, kStruct = 2;
constexpr std::uint32_t kDouble = 6, kSingle = 7, kUint64Array = 15;  // the classes of numbers
constexpr std::uint32_t kComplex = 0x800;                             // among the flags
constexpr std::size_t kTagBytes = 8, kMostDimensions = 32;
constexpr int kDeepest = 16;             // structs in structs
constexpr std::size_t kPiece = 1 << 16;  // bytes unpacked at once
constexpr Eigen::Index kShortest = 16;   // samples of an array that is taken without being named

struct MatArray {
  std::string name;                 ///< "run.acc", "hits{2}"
  Eigen::MatrixXd real, imaginary;  ///< imaginary: empty for real numbers
  bool single = false;

  [[nodiscard]] Eigen::Index longer() const { return std::max(real.rows(), real.cols()); }
  [[nodiscard]] bool is_vector() const {
    return imaginary.size() == 0 && std::min(real.rows(), real.cols()) == 1;
  }
  [[nodiscard]] bool is_scalar() const { return imaginary.size() == 0 && real.size() == 1; }
  [[nodiscard]] std::string last_name() const { return name.substr(name.find_last_of('.') + 1); }
  /// Whether what stands beside it, or above, belongs to an array: "run.t" to "run.acc".
  [[nodiscard]] bool concerns(const MatArray& array) const {
    return array.name.starts_with(name.substr(0, name.find_last_of('.') + 1));
  }
  [[nodiscard]] std::string text() const {
    return real.size() == 0 ? name
                            : fmt::format("{} ({} x {}{})", name, real.rows(), real.cols(),
                                          imaginary.size() > 0 ? ", complex" : "");
  }
};

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

/// Collects the arrays of numbers of a file of version 5 to 7. No memory is taken by a size that
/// the file states and does not hold.
class MatReader {
 public:
  explicit MatReader(const std::filesystem::path& path) : path_(path) {}

  std::vector<MatArray> read(std::string_view bytes) {
    const auto version = bytes.size() < 128 ? ""sv : bytes.substr(124, 4);
    if (version == "\0\2IM"sv || version == "\2\0MI"sv) {
      throw file_error(path_, "is a MATLAB file of version 7.3 (HDF5), which is not read",
                       "save it again, by save(F, '-v7')");
    }
    big_endian_ = version == "\1\0MI"sv;
    if (!big_endian_ && version != "\0\1IM"sv) {
      throw file_error(path_, "is no MATLAB file of version 5 to 7",
                       "save it again, by save(F, '-v7')");
    }
    const auto variables = elements(bytes.substr(128));
    require(!variables.empty());
    for (const Element& variable : variables) {
      if (variable.type != kCompressed) {
        take(variable, "", 0);
        continue;
      }
      const std::string text = unpacked(variable.data);
      const auto inside = elements(text);
      require(!inside.empty() && inside[0].type == kMatrix);
      take(inside[0], "", 0);
    }
    return std::move(arrays_);
  }

 private:
  void require(bool good) const {
    if (good) return;
    throw file_error(path_, "breaks off, or states more elements than it can hold",
                     "copy the file again");
  }

  /// Those that stand behind each other in `rest`; none where one of them breaks off.
  [[nodiscard]] std::vector<Element> elements(std::string_view rest) const {
    std::vector<Element> found;
    while (rest.size() >= kTagBytes) {
      const std::uint32_t type = word(rest, 0);
      const std::size_t small = type >> 16;  // bytes of data in the tag itself, up to four
      const std::size_t size = small > 0 ? small : word(rest, 1);
      const bool is_padded = type != kMatrix && type != kCompressed;
      const std::size_t stated = small > 0 ? 0 : is_padded ? (size + 7) / 8 * 8 : size;
      if (small > 4 || stated > rest.size() - kTagBytes) return {};
      found.push_back({type & 0xffffU, rest.substr(small > 0 ? 4 : kTagBytes, size)});
      rest.remove_prefix(kTagBytes + stated);
    }
    return found;
  }

  /// Adds the arrays of a variable and of those that it is made of. `name`: empty at the top.
  void take(const Element& variable, std::string name, int depth) {
    if (variable.type != kMatrix || (depth > 0 && variable.data.empty())) return;
    const auto parts = elements(variable.data);
    const auto is = [&](std::size_t k, std::uint32_t type) {
      return k < parts.size() && parts[k].type == type;
    };
    require(depth <= kDeepest && is(0, kUint32) && parts[0].data.size() == 8);
    const std::uint32_t flags = word(parts[0].data, 0), array_class = flags & 0xffU;
    const bool is_numeric = array_class >= kDouble && array_class <= kUint64Array;
    if (!is_numeric && array_class != kStruct && array_class != kCell) return;
    require(is(1, kInt32) && parts[1].data.size() <= 4 * kMostDimensions && is(2, kInt8));
    std::vector<double> sizes;
    for (std::size_t d = 0; d < parts[1].data.size() / 4; ++d) {
      sizes.push_back(word(parts[1].data, d));
    }
    const double count = std::accumulate(sizes.begin(), sizes.end(), 1.0, std::multiplies<>());
    if (depth == 0) name = to_utf8(parts[2].data);
    if (name.empty() || name.starts_with("__")) return;
    if (is_numeric) return take_numbers(parts, flags, sizes, name);
    std::size_t first = 3;  // of the parts that are variables
    std::vector<std::string> fields;
    if (array_class == kStruct) {
      require(is(3, kInt32) && parts[3].data.size() == 4 && is(4, kInt8));
      const std::size_t length = word(parts[3].data, 0);  // a field's name has so many bytes
      require(length > 0);
      for (std::size_t at = 0; at + length <= parts[4].data.size(); at += length) {
        const auto field = parts[4].data.substr(at, length);
        fields.push_back("." + to_utf8(field.substr(0, field.find('\0'))));
      }
      first = 5;
      if (fields.empty()) return;
    }
    const std::size_t each = std::max<std::size_t>(fields.size(), 1), all = parts.size() - first;
    require(count * static_cast<double>(each) <= static_cast<double>(all));
    for (std::size_t k = 0; k < static_cast<std::size_t>(count) * each; ++k) {
      const std::string place = count > 1 ? fmt::format("({})", k / each + 1) : "";
      take(parts[first + k],
           name + (fields.empty() ? fmt::format("{{{}}}", k + 1) : place + fields[k % each]),
           depth + 1);
    }
  }

  void take_numbers(const std::vector<Element>& parts, std::uint32_t flags,
                    const std::vector<double>& sizes, const std::string& name) {
    const bool is_complex = (flags & kComplex) != 0;
    if (sizes.size() != 2) {
      arrays_.push_back({fmt::format("{} of {} dimensions", name, sizes.size()), {}, {}, false});
      return;
    }
    require(parts.size() >= (is_complex ? 5 : 4));
    MatArray array{name, matrix(parts[3], sizes), {}, (flags & 0xffU) == kSingle};
    if (is_complex) array.imaginary = matrix(parts[4], sizes);
    if (array.real.size() > 0) arrays_.push_back(std::move(array));
  }

  [[nodiscard]] Eigen::MatrixXd matrix(const Element& part,
                                       const std::vector<double>& sizes) const {
    constexpr std::string_view kKinds = "_iuiuiuf_f__iu", kBytes = "01122444080088";
    const std::size_t type = part.type < kKinds.size() ? part.type : 0;
    const auto bytes = static_cast<std::size_t>(kBytes[type] - '0');
    require(bytes > 0 && sizes[0] * sizes[1] * static_cast<double>(bytes) ==
                             static_cast<double>(part.data.size()));
    return matrix_of({kKinds[type], bytes, is_swapped(big_endian_)}, part.data.data(),
                     static_cast<Eigen::Index>(sizes[0]), static_cast<Eigen::Index>(sizes[1]));
  }

  [[nodiscard]] std::uint32_t word(std::string_view data, std::size_t k) const {
    std::uint32_t value = 0;
    std::memcpy(&value, data.data() + 4 * k, 4);
    return is_swapped(big_endian_) ? __builtin_bswap32(value) : value;
  }

  const std::filesystem::path& path_;
  bool big_endian_ = false;
  std::vector<MatArray> arrays_;
};

using Arrays = std::vector<const MatArray*>;

/// The arrays for which `is` holds.
template <typename Is>
Arrays those(const std::vector<MatArray>& arrays, Is&& is) {
  Arrays found;
  for (const auto& array : arrays) {
    if (is(array)) found.push_back(&array);
  }
  return found;
}

bool holds(const Arrays& arrays, const MatArray& array) {
  return std::ranges::find(arrays, &array) != arrays.end();
}

bool differ_in_length(const Arrays& arrays) {
  return std::ranges::any_of(
      arrays, [&](const auto* array) { return array->longer() != arrays.front()->longer(); });
}

std::string list_of(const Arrays& arrays) {
  std::vector<std::string> texts;
  for (const auto* array : arrays) texts.push_back(array->text());
  return listed(texts);
}

/// The rate by a scalar of a usual name; 0: none. A second one that disagrees is noted.
double stated_rate(const std::vector<MatArray>& arrays, const MatArray& of,
                   std::vector<Note>& notes) {
  double rate = 0;
  std::string by;
  for (const auto& array : arrays) {
    if (!array.is_scalar() || !array.concerns(of)) continue;
    std::string label = lower_case(array.last_name());
    std::erase(label, '_');
    if (label == "sr" || label == "ts") label = label == "sr" ? "fs" : "dt";
    const double found = rate_of_label(label, array.real(0, 0), "");
    if (found == 0) continue;
    if (rate == 0) {
      rate = found, by = array.name;
    } else if (std::abs(found / rate - 1) > 1e-6) {
      add_note(notes, "rates_disagree", array.name,
               "{} gives {:.9g} Hz, {} gives {:.9g} Hz: the first is taken", by, rate, array.name,
               found);
    }
  }
  return rate;
}

/// Frequencies of an FFT where the file holds its rate ("fs", "freq") and block length N, a whole
/// number with N / 2 + 1 lines. Empty: it does not.
Eigen::VectorXd frequencies_by_rate(const std::vector<MatArray>& arrays, const MatArray& frfs) {
  std::vector<Note> ignored;
  double rate = stated_rate(arrays, frfs, ignored), block = 0;
  for (const auto& array : arrays) {
    if (!array.is_scalar()) continue;
    const double value = array.real(0, 0);
    if (value == std::floor(value) &&
        std::floor(value / 2) + 1 == static_cast<double>(frfs.longer())) {
      block = value;
    } else if (rate == 0 && value > 0 && lower_case(array.last_name()).starts_with("freq")) {
      rate = value;
    }
  }
  if (!(rate > 0) || !(block > 0) || !std::isfinite(rate)) return {};
  return Eigen::VectorXd::LinSpaced(frfs.longer(), 0, static_cast<double>(frfs.longer() - 1)) *
         (rate / block);
}

/// The arrays that a person names, or those of the one length there is.
Arrays chosen(const std::vector<MatArray>& arrays, const std::filesystem::path& path,
              const std::vector<std::string>& asked) {
  const Arrays complex =
      those(arrays, [](const MatArray& array) { return array.imaginary.size() > 0; });
  const Arrays real = those(arrays, [](const MatArray& array) {
    return array.imaginary.size() == 0 && array.longer() > 1;
  });
  Arrays taken;
  for (const auto& name : asked) {
    const auto found = std::ranges::find_if(real, [&](const MatArray* array) {
      return array->name == name || array->last_name() == name;
    });
    if (found == real.end()) {
      throw file_error(path, "has no array of that name", "there are: " + list_of(real), name);
    }
    taken.push_back(*found);
  }
  if (differ_in_length(taken)) {
    throw file_error(path, "the arrays named differ in length: " + list_of(taken),
                     "name arrays of one length");
  }
  if (!asked.empty()) {
    for (const auto* array : real) {
      if (array->longer() == taken.front()->longer() && is_time_name(array->last_name()) &&
          array->concerns(*taken.back()) && !holds(taken, *array)) {
        taken.insert(taken.begin(), array);
      }
    }
    return taken;
  }
  // Beside FRFs, a vector as long as they are holds their frequencies; what is shorter describes
  // them.
  Eigen::Index longest_frf = 0;
  for (const auto* array : complex) longest_frf = std::max(longest_frf, array->longer());
  const bool only_axes = std::ranges::all_of(real, [&](const MatArray* array) {
    return array->longer() < kShortest || (array->longer() == longest_frf && array->is_vector());
  });
  if (longest_frf >= kShortest && only_axes) {
    throw file_error(
        path, "holds complex numbers, no recording over time: " + list_of(complex),
        "rigfit modal takes FRFs, with a vector of their frequencies in the file (freq)");
  }
  taken = real;
  if (differ_in_length(taken)) {
    std::erase_if(taken, [](const auto* array) { return array->longer() < kShortest; });
  }
  if (taken.empty()) {
    throw file_error(path, "holds no array of samples" + (real.empty() ? "" : ": " + list_of(real)),
                     "save the samples as numeric arrays (a timetable or object only MATLAB reads: "
                     "use its .Variables)");
  }
  if (differ_in_length(taken)) {
    throw file_error(
        path, "holds arrays of several lengths: " + list_of(real),
        "say which to take: --variable NAME, or variables = [\"NAME\"] in the TOML file "
        "beside it");
  }
  return taken;
}

/// Refuses samples beside the times of another structure.
void check_times(const Arrays& taken, const std::filesystem::path& path) {
  Arrays times = taken;
  std::erase_if(times, [](const auto* array) { return !is_time_name(array->last_name()); });
  for (const auto* array : taken) {
    const bool own = std::ranges::any_of(times, [&](const MatArray* time) {
      return time == array ||
             (time->concerns(*array) && time->real.size() == times.front()->real.size() &&
              (time->real.reshaped() - times.front()->real.reshaped()).isZero(0));
    });
    if (own || times.empty()) continue;
    throw file_error(path, "holds structures with times of their own: " + list_of(taken),
                     "say which samples to take: --variable " + array->name, array->name);
  }
}

}  // namespace

Recording read_mat(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options) {
  const std::vector<MatArray> arrays = MatReader(path).read(bytes);
  const auto taken = chosen(arrays, path, options.variables);
  check_times(taken, path);
  CsvTable table;
  for (const auto* array : taken) {
    const std::string last = array->last_name();
    add_array(array->real, is_time_name(last) ? last : array->name, array->single, table);
  }
  const Arrays left = those(arrays, [&](const MatArray& array) {
    return (array.longer() >= kShortest || array.real.size() == 0) && !holds(taken, array);
  });
  if (!left.empty()) {
    add_note(table.notes, "left_out", "", "{} is taken, left out is {}", list_of(taken),
             list_of(left));
  }
  const double rate = stated_rate(arrays, *taken.front(), table.notes);
  return recording_of_arrays(std::move(table), path, "mat", options, rate);
}

FrfSet read_mat_frfs(std::string_view bytes, const std::filesystem::path& path,
                     const ReadOptions& options) {
  const std::vector<MatArray> arrays = MatReader(path).read(bytes);
  const auto& asked = options.variables;
  const Arrays complex = those(arrays, [&](const MatArray& array) {
    return array.imaginary.size() > 0 && array.longer() >= kShortest &&
           (asked.empty() || std::ranges::find(asked, array.name) != asked.end());
  });
  if (complex.size() != 1) {
    throw file_error(path,
                     complex.empty() ? "holds no complex array, so no FRFs"
                                     : "holds several complex arrays: " + list_of(complex),
                     complex.empty() ? "save FRFs as a complex array of lines x points, or give "
                                       "recordings of hits with --force CHANNEL"
                                     : "say which to take: --variable NAME");
  }
  const MatArray& frfs = *complex.front();
  Eigen::VectorXd frequency_hz;
  for (const auto& array : arrays) {
    const std::string name = lower_case(array.last_name());
    const bool named = name.starts_with("f") || name.find("freq") != std::string::npos ||
                       name == "x" || name == "axis";
    if (named && array.is_vector() && array.longer() == frfs.longer()) {
      frequency_hz = array.real.reshaped();
    }
  }
  const bool by_rate = frequency_hz.size() == 0;
  if (by_rate) frequency_hz = frequencies_by_rate(arrays, frfs);
  if (frequency_hz.size() == 0) {
    throw file_error(path, "holds " + frfs.text() + " but no vector of as many frequencies",
                     "save the frequencies in Hz beside it, as a vector named freq");
  }
  const bool wide = frfs.real.cols() == frequency_hz.size() && frfs.real.rows() != frfs.real.cols();
  Eigen::MatrixXcd H(frfs.real.rows(), frfs.real.cols());
  H.real() = frfs.real;
  H.imag() = frfs.imaginary;
  if (wide) H.transposeInPlace();
  std::vector<FrfPart> parts;
  for (Eigen::Index k = 0; k < H.cols(); ++k) {
    const int place = static_cast<int>(k) + 1;
    parts.push_back({{fmt::format("{} {}", frfs.last_name(), place), place, 0},
                     {"force", 0, 0},
                     FrfForm::unknown,
                     frequency_hz,
                     H.col(k),
                     {},
                     {},
                     path.string()});
  }
  FrfSet set = set_of_parts(parts);
  if (by_rate) {
    add_note(set.notes, "read_as", frfs.name,
             "no vector of frequencies: by the sampling rate and block "
             "length in the file they go to {:.9g} Hz",
             frequency_hz[frequency_hz.size() - 1]);
  }
  add_note(set.notes, "no_unit", frfs.name,
           "the FRFs have no unit: the numbers are kept as they are; frequencies and "
           "damping do not depend on it");
  return set;
}

}  // namespace rigfit::signal
