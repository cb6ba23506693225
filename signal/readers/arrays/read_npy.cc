#include "signal/readers/files/read_formats.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
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
  char kind = 'f';  ///< f, i, u
  std::size_t size = 8;
  bool swapped = false;
  bool fortran = false;
  std::vector<double> shape;
};

Header parse_header(const std::string& text, const std::string& file) {
  static const std::regex kHeader(
      R"(\{\s*'descr'\s*:\s*'([<>|=])([fiub])([1248])'\s*,)"
      R"(\s*'fortran_order'\s*:\s*(True|False)\s*,\s*'shape'\s*:\s*\(([0-9, ]*)\))"),
      kSize("[0-9]+");
  std::smatch found;
  if (!std::regex_search(text, found, kHeader, std::regex_constants::match_continuous)) {
    throw file_error(file,
                     "holds no plain numbers (but records, complex numbers or Python objects), or "
                     "its header is damaged",
                     "save an array of numbers with numpy.save", to_utf8(text.substr(0, 60)));
  }
  constexpr char kSwapped = std::endian::native == std::endian::big ? '<' : '>';
  Header header{*found[2].first == 'b' ? 'u' : *found[2].first,
                static_cast<std::size_t>(*found[3].first - '0'),
                found[1] == kSwapped,
                found[4] == "True",
                {}};
  const std::string sizes = found[5];
  for (std::sregex_iterator one(sizes.begin(), sizes.end(), kSize), end; one != end; ++one) {
    header.shape.push_back(std::strtod(one->str().c_str(), nullptr));
  }
  return header;
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
  double items = 1;
  for (const double n : header.shape) items *= n;
  if (items == 0 || header.shape.empty()) {
    throw file_error(file, "holds no samples", "record again");
  }
  const std::string shape = fmt::format("{}", fmt::join(header.shape, " x "));
  if (!(items * static_cast<double>(item) <= static_cast<double>(data.size()))) {
    throw file_error(file,
                     fmt::format("states an array of {}, {} bytes each, but holds {} bytes", shape,
                                 item, data.size()),
                     "copy the file again");
  }
  if (header.shape.size() > 2) {
    throw file_error(file, "holds an array of " + shape,
                     "save one with samples and channels only (two dimensions)");
  }
  const auto rows = static_cast<Eigen::Index>(header.shape[0]);
  const auto cols = static_cast<Eigen::Index>(header.shape.size() > 1 ? header.shape[1] : 1);
  // Parts of the array, so that numbers and file are in memory once.
  Eigen::MatrixXd values(rows, cols);
  const Eigen::Index length_of_run = header.fortran ? rows : cols;
  const Eigen::Index runs = values.size() / length_of_run;
  const auto run_bytes = static_cast<std::size_t>(length_of_run) * item;
  const Eigen::Index most = std::max<Eigen::Index>(1, (1 << 20) / length_of_run);
  for (Eigen::Index run = 0; run < runs; run += most) {
    const Eigen::Index count = std::min(most, runs - run);
    const std::size_t at = static_cast<std::size_t>(run) * run_bytes;
    std::string numbers(data.substr(at, static_cast<std::size_t>(count) * run_bytes));  // aligned
    for (std::size_t k = 0; header.swapped && k < numbers.size(); k += item) {
      std::reverse(numbers.data() + k, numbers.data() + k + item);
    }
    const Eigen::MatrixXd part = matrix_of(header.kind, item, numbers.data(), length_of_run, count);
    if (part.size() == 0) {
      throw file_error(file, "holds numbers of half precision, which are not read",
                       "save them as float32 or float64");
    }
    if (header.fortran) {
      values.middleCols(run, count) = part;
    } else {
      values.middleRows(run, count) = part.transpose();
    }
    if (options.done_with) options.done_with(begin + length + at + numbers.size());
  }
  CsvTable table;
  add_array(std::move(values), "", header.kind == 'f' && item == 4, table);
  return recording_of_arrays(std::move(table), path, "npy", options, 0);
}

}  // namespace rigfit::signal
