#include "signal/readers/read_recording.h"

#include <hdf5.h>
#include <matio.h>
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <memory>

#include "signal/readers/frequency_table.h"
#include "signal/recording/recording_time.h"

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

/// Walks the headers of a file of version 5 before libmatio, which reserves memory by the sizes
/// that they state and loops over them. Throws when the file is of another version than 5 to 7.3,
/// breaks off, or has an array, struct, cell or function handle of other sizes than its header
/// states. Of version 7.3 (HDF5) only the version is looked at.
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

// ---- Variables by libmatio

constexpr int kDeepest = 6;      // structs in structs
constexpr Index kShortest = 16;  // samples of an array that is taken without being named

struct MatArray {
  std::string name;          ///< "run.acc", "hits{2}"
  MatrixXd real, imaginary;  ///< imaginary: empty for real numbers
  bool single = false;

  [[nodiscard]] Index longer() const { return std::max(real.rows(), real.cols()); }
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

/// Whether arrays of a class hold numbers.
bool is_numeric(matio_classes type) { return type >= MAT_C_DOUBLE && type <= MAT_C_UINT64; }

/// Elements of an array by its dimensions.
double elements_of(const matvar_t& variable) {
  double count = variable.dims == nullptr || variable.rank < 1 ? 0 : 1;
  for (int d = 0; count > 0 && d < variable.rank; ++d) {
    count *= static_cast<double>(variable.dims[d]);
  }
  return count;
}

/// Calls `take` with a variable, and where it returns true with those that it is made of.
void each_variable(matvar_t& variable, const std::string& name, int depth,
                   const std::function<bool(matvar_t&, const std::string&)>& take) {
  const bool is_struct = variable.class_type == MAT_C_STRUCT;
  if (depth > kDeepest || !take(variable, name) || variable.data == nullptr ||
      (!is_struct && variable.class_type != MAT_C_CELL)) {
    return;
  }
  const auto count = static_cast<std::size_t>(elements_of(variable));  // held, as arrays_in asks
  char* const* const names = is_struct ? Mat_VarGetStructFieldnames(&variable) : nullptr;
  const unsigned fields = names == nullptr ? 0 : Mat_VarGetNumberOfFields(&variable);
  for (std::size_t k = 0; k < count; ++k) {
    const std::string at = count > 1 ? fmt::format("({})", k + 1) : "";
    for (unsigned f = 0; f < fields; ++f) {
      matvar_t* const field = Mat_VarGetStructFieldByIndex(&variable, f, k);
      if (field == nullptr || names[f] == nullptr) continue;
      each_variable(*field, name + at + "." + to_utf8(names[f]), depth + 1, take);
    }
    matvar_t* const cell = is_struct ? nullptr : Mat_VarGetCell(&variable, static_cast<int>(k));
    if (cell != nullptr)
      each_variable(*cell, fmt::format("{}{{{}}}", name, k + 1), depth + 1, take);
  }
}

/// Adds a variable that was read, if it is a numeric array.
void add_numbers(const matvar_t& variable, const std::string& name, std::vector<MatArray>& arrays) {
  const double count = elements_of(variable);
  if (count == 0 || variable.data == nullptr || variable.class_type == MAT_C_STRUCT ||
      variable.class_type == MAT_C_CELL) {
    return;
  }
  if (variable.rank != 2) {
    arrays.push_back({fmt::format("{} of {} dimensions", name, variable.rank), {}, {}, false});
    return;
  }
  const auto rows = static_cast<Index>(variable.dims[0]);
  const auto cols = static_cast<Index>(variable.dims[1]);
  // The data must be as many numbers of the class's own size.
  const std::size_t size = Mat_SizeOfClass(variable.class_type);
  if (!is_numeric(variable.class_type) || size == 0 ||
      static_cast<double>(variable.nbytes) < count * static_cast<double>(size))
    return;
  const void *re = variable.data, *im = nullptr;
  if (variable.isComplex != 0) {
    const auto* const split = static_cast<const mat_complex_split_t*>(variable.data);
    re = split->Re, im = split->Im;
    if (re == nullptr || im == nullptr) return;
  }
  const char kind = "ffiuiuiuiu"[variable.class_type - MAT_C_DOUBLE];
  const auto numbers = [&](const void* data) {
    return matrix_of({kind, size}, static_cast<const char*>(data), rows, cols);
  };
  MatArray array{name, numbers(re), {}, variable.class_type == MAT_C_SINGLE};
  if (im != nullptr) array.imaginary = numbers(im);
  arrays.push_back(std::move(array));
}

/// The numeric arrays of a file. What is too large for the file is refused before it is read.
std::vector<MatArray> arrays_in(std::string_view bytes, const std::filesystem::path& path) {
  check_mat_headers(bytes, path);
  // HDF5's own messages on standard error are silent here: they show in what is read.
  H5E_auto2_t print = nullptr;
  void* data = nullptr;
  H5Eget_auto2(H5E_DEFAULT, &print, &data);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const std::shared_ptr<void> later(
      nullptr, [print, data](void*) { H5Eset_auto2(H5E_DEFAULT, print, data); });
  const std::unique_ptr<mat_t, int (*)(mat_t*)> file(Mat_Open(path.c_str(), MAT_ACC_RDONLY),
                                                     &Mat_Close);
  if (!file) {
    throw file_error(path, "is no MATLAB file that can be read",
                     "save it again, by save(F, '-v7')");
  }
  std::vector<MatArray> arrays;
  const bool hdf5 = Mat_GetVersion(file.get()) == MAT_FT_MAT73;
  bool any = false;
  while (matvar_t* const next = Mat_VarReadNextInfo(file.get())) {
    any = true;
    const std::unique_ptr<matvar_t, void (*)(matvar_t*)> variable(next, &Mat_VarFree);
    const std::string name = next->name == nullptr ? "" : to_utf8(next->name);
    if (name.empty() || name.starts_with("__") || name.starts_with("#")) continue;
    // Deflate packs at most a thousand to one.
    const double most = hdf5 ? 1100 * static_cast<double>(bytes.size()) + 4096 : 1e18;
    bool held = true;
    each_variable(*next, name, 0, [&](const matvar_t& one, const std::string&) {
      return held = held && elements_of(one) <= most;
    });
    if (!held) {
      throw file_error(path, "states more numbers than the file can hold", "copy the file again",
                       name);
    }
    if (next->class_type != MAT_C_STRUCT && next->class_type != MAT_C_CELL &&
        !is_numeric(next->class_type)) {
      continue;
    }
    if (Mat_VarReadDataAll(file.get(), next) != 0) {
      throw file_error(path, "breaks off inside a variable", "copy the file again", name);
    }
    each_variable(*next, name, 0, [&](const matvar_t& one, const std::string& own) {
      add_numbers(one, own, arrays);
      return true;
    });
  }
  if (!any) throw file_error(path, "breaks off, or holds no variable", "copy the file again");
  return arrays;
}

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

/// What Testlab exports: the axis x_values.start_value, .increment of y_values.values. NaN: none.
std::array<double, 2> testlab_axis(const std::vector<MatArray>& arrays, const MatArray& of) {
  const std::string values = "y_values.values";
  std::array<double, 2> axis{kNaN, kNaN};
  if (!of.name.ends_with(values)) return axis;
  const std::string x = of.name.substr(0, of.name.size() - values.size()) + "x_values.";
  for (const auto& array : arrays) {
    if (!array.is_scalar()) continue;
    if (array.name == x + "start_value") axis[0] = array.real(0, 0);
    if (array.name == x + "increment") axis[1] = array.real(0, 0);
  }
  return axis;
}

/// The rate by a scalar of a usual name; 0: none. A second one that disagrees is noted.
double stated_rate(const std::vector<MatArray>& arrays, const MatArray& of,
                   std::vector<Note>& notes) {
  double rate = 0;
  std::string by;
  if (const auto [start, step] = testlab_axis(arrays, of); step > 0) {
    add_note(notes, "assumed", of.name,
             "x_values.increment, {:g}, is taken as s; of a spectrum it is Hz", step);
    return 1 / step;
  }
  for (const auto& array : arrays) {
    if (!array.is_scalar() || !array.concerns(of)) continue;
    std::string label = lower_case(array.last_name());
    std::erase(label, '_');
    if (label == "sr" || label == "ts") label = label == "sr" ? "fs" : "dt";
    // A variable of this name is as likely a deflection, a tolerance or a decrement.
    if (label == "delta" || label == "interval" || label == "increment") continue;
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
  Index longest_frf = 0;
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
        "say which to take: --variable NAME, or variables = [\"NAME\"] in the TOML file beside it");
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

/// Frequencies of an FFT where the file holds its rate ("fs", "freq") and block length N, a whole
/// number with N / 2 + 1 lines. Empty: it does not.
VectorXd frequencies_by_rate(const std::vector<MatArray>& arrays, const MatArray& frfs) {
  std::vector<Note> ignored;
  double rate = stated_rate(arrays, frfs, ignored), block = 0;
  for (const auto& array : arrays) {
    if (!array.is_scalar()) continue;
    const double value = array.real(0, 0), lines = std::floor(value / 2) + 1;
    if (value == std::floor(value) && lines == static_cast<double>(frfs.longer())) {
      block = value;
    } else if (rate == 0 && value > 0 && lower_case(array.last_name()).starts_with("freq")) {
      rate = value;
    }
  }
  if (!(rate > 0) || !(block > 0) || !std::isfinite(rate)) return {};
  return ArrayXd::LinSpaced(frfs.longer(), 0, static_cast<double>(frfs.longer() - 1)) *
         (rate / block);
}

}  // namespace

Recording read_mat(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options) {
  const std::vector<MatArray> arrays = arrays_in(bytes, path);
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
  const std::vector<MatArray> arrays = arrays_in(bytes, path);
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
  VectorXd frequency_hz;
  for (const auto& array : arrays) {
    const std::string name = lower_case(array.last_name());
    const bool named = name.starts_with("f") || name.find("freq") != std::string::npos ||
                       name == "x" || name == "axis";
    if (named && array.is_vector() && array.longer() == frfs.longer()) {
      frequency_hz = array.real.reshaped();
    }
  }
  if (const auto [start, step] = testlab_axis(arrays, frfs); step > 0 && start >= 0) {
    const auto last = static_cast<double>(frfs.longer() - 1);
    frequency_hz = start + step * ArrayXd::LinSpaced(frfs.longer(), 0, last);
  }
  const bool by_rate = frequency_hz.size() == 0;
  if (by_rate) frequency_hz = frequencies_by_rate(arrays, frfs);
  if (frequency_hz.size() == 0) {
    throw file_error(path, "holds " + frfs.text() + " but no vector of as many frequencies",
                     "save the frequencies in Hz beside it, as a vector named freq");
  }
  const bool wide = frfs.real.cols() == frequency_hz.size() && frfs.real.rows() != frfs.real.cols();
  MatrixXcd H(frfs.real.rows(), frfs.real.cols());
  H.real() = frfs.real;
  H.imag() = frfs.imaginary;
  if (wide) H.transposeInPlace();
  std::vector<FrfPart> parts;
  for (Index k = 0; k < H.cols(); ++k) {
    const int place = static_cast<int>(k) + 1;
    parts.push_back({{fmt::format("{} {}", frfs.last_name(), place), place, 0},
                     {"force", 0, 0},
                     {},
                     frequency_hz,
                     H.col(k),
                     {},
                     {},
                     path.string()});
  }
  FrfSet set = set_of_parts(parts);
  if (by_rate) {
    add_note(set.notes, "read_as", frfs.name,
             "no vector of frequencies: by the sampling rate and block length in the file they go "
             "to {:.9g} Hz",
             frequency_hz[frequency_hz.size() - 1]);
  }
  return set;
}

}  // namespace rigfit::signal
