// Cost against size: time and memory of what people scale up, and the slopes on logarithmic
// scales. 1 is linear.
//
// A series goes on until its largest size, or until the next size would take longer or more memory
// than is allowed; where it stopped is said. Memory is the peak of the resident set over what was
// resident before (Linux; absent elsewhere), inputs made for the study included where they belong
// to the task.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rigfit::apps {

struct SizeRow {
  double size = 0;
  double wall_s = 0;                 ///< median, or of one run where it is long
  std::optional<double> peak_bytes;  ///< above what was resident before
};

struct SizeSeries {
  std::string task;
  std::string method;
  std::string size_of;  ///< "segments", "poles", "channels", "samples", "bytes of file"
  std::vector<SizeRow> rows;
  std::optional<double> time_slope, memory_slope;  ///< of the last three rows
  std::string stopped;                             ///< why before the largest size
};

struct SizeLimits {
  double seconds = 120;        ///< for one size
  double memory_share = 0.5;   ///< of what is free
  double largest_share = 1.0;  ///< of every series' largest size
};

/// Least-squares slope of ln y over ln x.
[[nodiscard]] double log_slope(const std::vector<double>& x, const std::vector<double>& y);

/// All series, each handed over as soon as it is done. `task` empty: all.
void run_size_study(const SizeLimits& limits, const std::vector<std::string>& tasks,
                    const std::function<void(const SizeSeries&)>& done);

/// The tasks there are.
[[nodiscard]] const std::vector<std::string>& size_tasks();

}  // namespace rigfit::apps
