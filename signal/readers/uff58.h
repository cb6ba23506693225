// Universal files: their lines and numbers, and dataset 58 ("function at nodal degree of freedom")
// as it stands in the file. Layout: SDRC Universal File Datasets, dataset 58; binary form 58b by
// the University of Cincinnati's Structural Dynamics Research Laboratory.
//
// Records of 80 columns: five identification lines, the degree of freedom, the data form, then the
// abscissa, ordinate, ordinate-denominator and z axes; then the numbers, in text (6E13.5 single,
// 4E20.12 double precision) or as IEEE floats of either byte order.
#pragma once

#include <climits>

#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// The lines of a universal file, dataset by dataset: marks of -1, fixed
/// columns, numbers. Lines and fields are views of the file's bytes.
class UffText {
 public:
  UffText(std::string_view bytes, const std::string& file)
      : bytes_(bytes), rest_(bytes), file_(file) {}

  /// Goes behind the line with the number of the next dataset, which it returns; nothing at the end
  /// of the file. Throws RecordingError for a mark without a number behind it.
  [[nodiscard]] std::optional<int> next_dataset();
  /// The line with the dataset's number.
  [[nodiscard]] std::string_view head() const { return head_; }
  [[nodiscard]] bool any() const { return head_.data() != nullptr; }

  /// The dataset's next line; nothing at its end mark, and at the end of the
  /// file. Throws RecordingError for a line that the file breaks off in.
  [[nodiscard]] std::optional<std::string_view> line();
  /// The same; throws RecordingError where the dataset ends.
  std::string_view needed_line();
  /// Goes behind the dataset's end mark; false where there is none.
  bool skip_to_end();

  /// What comes next up to the file's end, and going behind `bytes` of it.
  [[nodiscard]] std::string_view rest() const { return rest_; }
  void skip(std::size_t bytes) { rest_.remove_prefix(bytes); }
  /// The first of the lines that holds "-1" and nothing else, and those behind it.
  [[nodiscard]] static std::optional<std::string_view> mark(std::string_view lines);

  /// 1-based line of a part of the file; lines behind binary values are counted
  /// as their bytes have it.
  [[nodiscard]] long line_of(std::string_view part) const;
  /// The dataset breaks off at this part of the file.
  [[nodiscard]] RecordingError broken_off(std::string_view at) const;
  /// About `value`, a part of the file; where it is empty, about its line.
  [[nodiscard]] RecordingError error(std::string_view value, std::string problem,
                                     std::string remedy) const;

  /// Columns `from` .. `from + width` of a line without blanks, as text and as
  /// numbers; 0 where they are blank. Throws RecordingError for what is no
  /// number, or no whole one from `low` to `high`.
  [[nodiscard]] static std::string_view columns(std::string_view line, std::size_t from,
                                                std::size_t width);
  [[nodiscard]] double number(std::string_view line, std::size_t from, std::size_t width) const;
  int integer(std::string_view line, std::size_t from, std::size_t width,
              const char* problem = "not a whole number", int low = INT_MIN,
              int high = INT_MAX) const;

  /// The number behind blanks that `rest`, a part of the file, begins with;
  /// `rest` then begins behind it. Nothing at its end. A word for no value is
  /// NaN. Throws RecordingError for other text.
  [[nodiscard]] std::optional<double> next_number(std::string_view& rest) const;

 private:
  std::string_view bytes_, rest_;
  const std::string& file_;
  std::string_view head_;
  mutable std::size_t counted_to_ = 0;  // in line `counted_`
  mutable long counted_ = 1;
};

/// Function types (record 6, field 1) that we name.
namespace uff58_function {
enum Type { general = 0, time_response = 1, frf = 4, coherence = 6 };
}

struct Uff58Axis {
  int data_type =
      0;  ///< specific data type: 8 displacement, 12 acceleration, 13 force, 17 time ...
  std::string label, unit;  ///< as written, UTF-8; empty: NONE
};

struct Uff58 {
  long line = 0;  ///< line of the dataset's number in the file
  bool binary = false;
  std::array<std::string, 5> id;  ///< UTF-8, no blanks at the end
  int function_type = 0;
  /// Direction: +-1 x, +-2 y, +-3 z, +-4.. rotations, 0 scalar. Name: the entity; empty: NONE.
  MeasuredPoint response, reference;
  bool complex = false;
  bool single_precision = false;
  bool even = true;
  double abscissa_start = 0, abscissa_step = 0;  ///< when even
  /// Half a unit of the last digit that the step is printed with.
  double abscissa_step_half_digit = 0;
  Uff58Axis abscissa, ordinate, denominator;
  VectorXd x;     ///< when uneven
  VectorXd real;  ///< values, or their real parts
  VectorXd imag;  ///< when complex
  /// What dataset 58 has no exact place for is kept in identification lines 4 and 5 as "rigfit
  /// key=value ...", so that our own files come back as they were. Other programs see a line of
  /// text. Empty: the file is not ours.
  std::map<std::string, std::string> remark;

  /// The number of that key; `fallback` when there is none or it is not a finite number.
  [[nodiscard]] double noted(const std::string& key, double fallback = 0) const;
};

/// The datasets 58 of a file. `done_with` is told how far the file has been read. Throws
/// RecordingError with the line for anything that cannot be read.
[[nodiscard]] std::vector<Uff58> read_uff58(std::string_view bytes, const std::string& file,
                                            const std::function<void(std::size_t)>& done_with = {});

/// The code of an axis: +-1 x, +-2 y, +-3 z; 0: oblique, or not known.
[[nodiscard]] int uff58_direction(const std::array<double, 3>& axis);
/// "+X" to "-RZ" of a direction's code; empty: none.
[[nodiscard]] std::string uff58_direction(int direction);

/// Specific data types of axes and the quantities they are.
[[nodiscard]] Quantity uff58_quantity(int data_type);
[[nodiscard]] int uff58_data_type(Quantity quantity);

}  // namespace rigfit::signal
