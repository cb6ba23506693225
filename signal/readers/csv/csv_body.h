// The lines of a table of numbers, parsed straight into columns.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "signal/readers/csv/csv_layout.h"

namespace rigfit::signal {

struct CsvBody {
  /// One per column of the layout; those not asked for are empty. NaN where there is no number.
  std::vector<Eigen::VectorXd> columns;
  std::vector<long> missing;  ///< NaN in each
  /// Most digits behind the decimal sign, in the last lines (the first ones where these hold no
  /// number; 400 where neither do).
  std::vector<int> decimals;
  Eigen::Index rows = 0;
  long short_rows = 0, first_short_line = 0;  ///< rows with fewer fields than columns
  long comment_lines = 0;
  long footer_line = 0;          ///< first line of text behind the table; 0: none
  bool incomplete_last = false;  ///< the last line broke off and was left out
  long empty_rows_at_end = 0;    ///< left out
};

/// Parses the columns that `wanted` marks. Throws RecordingError with line and column for a field
/// that is neither a number nor a word for none, for too many fields, and for a table so ragged
/// that most of it would be empty. `progress`, when given, is told now and then how many bytes are
/// done with.
[[nodiscard]] CsvBody parse_csv_body(std::string_view bytes, const CsvLayout& layout,
                                     const std::vector<bool>& wanted, const std::string& file,
                                     const std::function<void(std::size_t)>& progress = {});

}  // namespace rigfit::signal
