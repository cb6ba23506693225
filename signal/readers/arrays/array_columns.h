// Arrays of numbers (NumPy, MATLAB) as a table of columns, and that as a recording.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// A column of an array; `name` as CSV titles have it ("Force [N]"), empty: none.
struct ArrayColumn {
  std::string name;
  Eigen::VectorXd values;
  bool single = false;  ///< held in single precision: times are known to 6e-8 of their size
};

/// The longer side of `values` is time: each column of it, or each row where `values` is wide,
/// which is noted. `name` stands in front of the columns' numbers.
[[nodiscard]] std::vector<ArrayColumn> columns_of(const Eigen::Ref<const Eigen::MatrixXd>& values,
                                                  const std::string& name, bool single,
                                                  std::vector<Note>& notes);

/// Columns of the same length. Times are the column of such a name, or the first of several where
/// it rises in equal steps (noted). `stated_rate_hz`: by the file, 0: not. Throws RecordingError.
[[nodiscard]] Recording recording_of_columns(std::vector<ArrayColumn> columns,
                                             const std::filesystem::path& path,
                                             const std::string& format, const ReadOptions& options,
                                             double stated_rate_hz, std::vector<Note> notes);

}  // namespace rigfit::signal
