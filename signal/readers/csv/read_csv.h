// Tables of text as loggers write them, to a Recording (or, without a time, to named columns).
//
// Separator (comma, semicolon, tab, blanks), decimal sign, byte-order mark, quotes, line ends and
// the extent of the header are found from the text. Names and units stand in the header in any of
// the usual ways ("Time (s),Force [N]", a row of units, rows with labels in front, "rate_gyro_V").
// What is left out is noted, never dropped silently.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>
#include <vector>

#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// `bytes`: the whole file; `path` for messages. Throws RecordingError.
[[nodiscard]] Recording read_csv(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {},
                                 const std::function<void(std::size_t)>& done_with = {});

/// Named columns in SI without one of them being time: a results table, a load-deflection record.
struct Table {
  std::filesystem::path path;
  std::vector<Channel> columns;  ///< of the same length, NaN where empty
  std::vector<Note> notes;

  /// Rows of every column.
  [[nodiscard]] Eigen::Index rows() const {
    return columns.empty() ? 0 : columns.front().samples.size();
  }
  /// As Recording::channel_index.
  [[nodiscard]] Eigen::Index column_index(const std::string& name) const;
};

/// Reads text of a table; `path` is for messages. Throws RecordingError.
[[nodiscard]] Table read_table(std::string_view bytes, const std::filesystem::path& path);
/// Reads a file. Throws RecordingError.
[[nodiscard]] Table read_table(const std::filesystem::path& path);

}  // namespace rigfit::signal
