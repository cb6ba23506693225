// How a table of text is laid out: separator, decimal sign, where its numbers begin, what each
// column is called and holds. Found from the text itself, by looking at lines all over the file.
#pragma once

#include <string>
#include <string_view>

#include "signal/readers/csv/csv_column.h"

namespace rigfit::signal {

/// Throws RecordingError when there is no table of numbers in the text, and when its commas can be
/// read in two ways and `options` do not say. `file` is for messages.
[[nodiscard]] CsvLayout find_csv_layout(std::string_view bytes, const std::string& file,
                                        const ReadOptions& options = {});

/// 1-based number of the line that `offset` is in.
[[nodiscard]] long line_number(std::string_view bytes, std::size_t offset);

/// End of the line that begins at `from` (offset of its '\n' or '\r', or the size).
[[nodiscard]] std::size_t line_end(std::string_view bytes, std::size_t from);
/// Offset of the line after the one that ends at `end`.
[[nodiscard]] std::size_t next_line(std::string_view bytes, std::size_t end);

}  // namespace rigfit::signal
