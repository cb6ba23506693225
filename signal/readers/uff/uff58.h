// Dataset 58 of the Universal File Format ("function at nodal degree of freedom"), as it stands in
// the file. Layout: SDRC Universal File Datasets, dataset 58; binary form 58b by the University of
// Cincinnati's Structural Dynamics Research Laboratory.
//
// Records of 80 columns: five identification lines, the degree of freedom, the data form, then the
// abscissa, ordinate, ordinate-denominator and z axes; then the numbers, in text (6E13.5 single,
// 4E20.12 double precision) or as IEEE floats of either byte order.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "signal/recording/quantity.h"

namespace rigfit::signal {

/// Function types (record 6, field 1) that we name.
namespace uff58_function {
inline constexpr int kGeneral = 0, kTimeResponse = 1, kFrf = 4, kCoherence = 6;
}

/// Words for a function type, such as "power spectral density".
[[nodiscard]] const char* uff58_function_name(int type);

struct Uff58Axis {
  int data_type =
      0;  ///< specific data type: 8 displacement, 12 acceleration, 13 force, 17 time ...
  std::string label, unit;  ///< as written, UTF-8; empty: NONE
};

struct Uff58Point {
  std::string entity;  ///< empty: NONE
  int node = 0;
  int direction = 0;  ///< +-1 x, +-2 y, +-3 z, +-4.. rotations, 0 scalar
};

struct Uff58 {
  long line = 0;  ///< line of the dataset's number in the file
  bool binary = false;
  std::array<std::string, 5> id;  ///< UTF-8, no blanks at the end
  int function_type = 0;
  Uff58Point response, reference;
  bool complex = false;
  bool single_precision = false;
  bool even = true;
  double abscissa_start = 0, abscissa_step = 0;  ///< when even
  /// Half a unit of the last digit that the step is printed with.
  double abscissa_step_half_digit = 0;
  Uff58Axis abscissa, ordinate, denominator;
  Eigen::VectorXd x;     ///< when uneven
  Eigen::VectorXd real;  ///< values, or their real parts
  Eigen::VectorXd imag;  ///< when complex
  /// What dataset 58 has no exact place for is kept in identification lines 4 and 5 as "rigfit
  /// key=value ...", so that our own files come back as they were. Other programs see a line of
  /// text. Empty: the file is not ours.
  std::map<std::string, std::string> remark;

  /// The number of that key; `fallback` when there is none or it is not a finite number.
  [[nodiscard]] double noted(const std::string& key, double fallback = 0) const;
};

struct Uff58File {
  std::vector<Uff58> functions;
  std::vector<int> other_datasets;   ///< numbers of datasets that are not 58
  std::vector<std::string> remarks;  ///< such as a missing end mark, for a person
};

/// `done_with` is told how far the file has been read. Throws RecordingError with the line for
/// anything that cannot be read.
[[nodiscard]] Uff58File read_uff58(std::string_view bytes, const std::string& file,
                                   const std::function<void(std::size_t)>& done_with = {});

/// "+X" to "-RZ" of a direction's code; empty: none.
[[nodiscard]] std::string uff58_direction(int direction);

/// Specific data types of axes and the quantities they are.
[[nodiscard]] Quantity uff58_quantity(int data_type);
[[nodiscard]] int uff58_data_type(Quantity quantity);

}  // namespace rigfit::signal
