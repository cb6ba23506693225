// Says what is wrong with a recording so that the person who made it can fix it.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "document/document_error.h"

namespace rigfit::signal {

/// Where in a recording.
struct RecordingPlace {
  std::string file;
  long line = 0;          ///< 1-based; 0: not tied to a line
  long column = 0;        ///< 1-based column of the table or character position; 0: none
  std::string channel{};  ///< empty: none
  std::string value{};    ///< the offending text, empty: none

  [[nodiscard]] std::string before() const {
    return document::place_text(file, line, column) +
           (channel.empty() ? "" : "channel \"" + channel + "\": ");
  }
  [[nodiscard]] std::string behind() const { return value.empty() ? "" : " (\"" + value + "\")"; }
};

/// A recording that cannot be read.
using RecordingError = document::InputError<RecordingPlace>;

/// About the whole file.
[[nodiscard]] inline RecordingError file_error(const std::filesystem::path& file,
                                               std::string problem, std::string remedy,
                                               std::string value = "") {
  return {{file.string(), 0, 0, "", std::move(value)}, std::move(problem), std::move(remedy)};
}

}  // namespace rigfit::signal
