#include "signal/recording/recording_error.h"

#include <utility>

namespace rigfit::signal {

std::string RecordingPlace::before() const {
  const std::string place = document::place_text(file, line, column);
  return (place.empty() ? ": " : place) + (channel.empty() ? "" : "channel \"" + channel + "\": ");
}

std::string RecordingPlace::behind() const { return value.empty() ? "" : " (\"" + value + "\")"; }

RecordingError file_error(const std::filesystem::path& file, std::string problem,
                          std::string remedy, std::string value) {
  return {{file.string(), 0, 0, "", std::move(value)}, std::move(problem), std::move(remedy)};
}

}  // namespace rigfit::signal
