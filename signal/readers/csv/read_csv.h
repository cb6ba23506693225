// Reads text tables as loggers write them into a Recording.
//
// Separator (comma, semicolon, tab, blanks), decimal sign, byte-order mark, quotes, line ends and
// the extent of the header are found from the text. Names and units stand in the header in any of
// the usual ways ("Time (s),Force [N]", a row of units, rows with labels in front, "rate_gyro_V").
// Everything left out is noted.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string_view>

#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// `bytes` is the whole file, `path` is used in messages; `done_with`, if given, is called with the
/// bytes read so far. Throws RecordingError.
[[nodiscard]] Recording read_csv(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {},
                                 const std::function<void(std::size_t)>& done_with = {});

}  // namespace rigfit::signal
