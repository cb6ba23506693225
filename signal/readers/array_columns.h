// Arrays of numbers (NumPy, MATLAB) as a table of columns, and that as a recording.
#pragma once

#include <Eigen/Core>
#include <bit>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "signal/readers/csv_table.h"
#include "signal/readers/recording_description.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// How numbers stand in a file.
struct NumberType {
  char kind = 'f';       ///< 'f' floating point, 'i' whole, 'u' whole without sign
  std::size_t size = 8;  ///< bytes
  bool swapped = false;  ///< in the other byte order than here
};
/// Whether numbers of this byte order have the other one than here.
[[nodiscard]] constexpr bool is_swapped(bool big_endian) {
  return big_endian != (std::endian::native == std::endian::big);
}

/// The numbers at `bytes`, column after column or, `by_rows`, row after row, as doubles. Empty:
/// there is no such type.
[[nodiscard]] Eigen::MatrixXd matrix_of(const NumberType& type, const char* bytes,
                                        Eigen::Index rows, Eigen::Index cols, bool by_rows = false);

/// Walks the headers of a file of version 5 before libmatio, which reserves memory by the sizes
/// that they state and loops over them. Throws when the file is of another version than 5 to 7.3,
/// breaks off, or has an array, struct, cell or function handle of other sizes than its header
/// states. Of version 7.3 (HDF5) only the version is looked at.
void check_mat_headers(std::string_view bytes, const std::filesystem::path& path);

/// Adds an array's columns or, where it is wide, its rows to the table, with a note: its longer
/// side is time. `name`, as titles of CSV have it ("Force [N]"), stands in front of their numbers.
/// `single`: held in single precision, so that times are known to 6e-8 of their size.
void add_array(const Eigen::MatrixXd& values, const std::string& name, bool single,
               CsvTable& table);

/// Times are the column of such a name, or the first of several where it rises in equal steps
/// (noted). `stated_rate_hz`: by the file, 0: not. Throws RecordingError.
[[nodiscard]] Recording recording_of_arrays(CsvTable table, const std::filesystem::path& path,
                                            const std::string& format, const ReadOptions& options,
                                            double stated_rate_hz);

}  // namespace rigfit::signal
