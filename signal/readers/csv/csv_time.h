// The column of a table that holds the times, and the sample rate that it gives.
//
// By its name ("time", "Zeit", "t" ...), by clock times in it, or, first and without a name, by
// rising in equal steps (also as a coarse clock shows them) over more rows than a table of loads
// has. A first column that counts the samples is no channel either.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "signal/readers/csv/csv_columns.h"
#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// `options` give the unit of the times where the table does not. Rate, start, jitter and notes on
/// the times go to `recording`. Clock times in `table` become seconds from the first. Returns the
/// channels of `table` that are no channels of the recording. Throws RecordingError when sampling
/// is not uniform and times are missing.
[[nodiscard]] std::vector<std::size_t> take_csv_times(CsvTable& table, const std::string& file,
                                                      Recording& recording,
                                                      const ReadOptions& options = {});

/// Whether values rise as the times of even samples do, and there are enough of them.
[[nodiscard]] bool looks_like_time(const Eigen::VectorXd& values, int decimals);

}  // namespace rigfit::signal
