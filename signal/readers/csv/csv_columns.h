// A table of columns, of text or of arrays, as channels: which are taken, under which names and in
// which units, and what is left out.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "signal/readers/csv/csv_layout.h"
#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

struct CsvTable {
  std::string file;  ///< for messages
  CsvLayout layout;
  std::vector<Channel> channels;
  std::vector<std::size_t> column;  ///< column of each channel in the file
  std::vector<int> decimals;        ///< decimals printed of each channel's numbers
  std::vector<Note> notes;
};

/// `bytes`: text as text_without_mark gives it. `done_with` is told how far the body has been read.
/// Throws RecordingError.
[[nodiscard]] CsvTable read_csv_columns(std::string_view bytes, const std::string& file,
                                        const std::function<void(std::size_t)>& done_with,
                                        const ReadOptions& options = {});

/// Text without its byte-order mark; UTF-16, with a mark or without, is put into `converted`.
/// Throws RecordingError for binary data.
[[nodiscard]] std::string_view text_without_mark(std::string_view bytes, std::string& converted,
                                                 const std::string& file);

}  // namespace rigfit::signal
