#include "signal/recording/recording_error.h"

#include <fmt/format.h>

namespace rigfit::signal {
namespace {

std::string message(const RecordingError::Where& where, const std::string& problem,
                    const std::string& remedy) {
  std::string text = where.file;
  if (!where.cell.empty()) {
    text += ":" + where.cell;
  } else {
    if (where.line > 0) text += fmt::format(":{}", where.line);
    if (where.column > 0) text += fmt::format(":{}", where.column);
  }
  text += ": ";
  if (!where.channel.empty()) text += fmt::format("channel \"{}\": ", where.channel);
  text += problem;
  if (!where.value.empty()) text += fmt::format(" (\"{}\")", where.value);
  if (!remedy.empty()) text += "; " + remedy;
  return text;
}

}  // namespace

RecordingError::RecordingError(Where where, std::string problem, std::string remedy)
    : std::runtime_error(message(where, problem, remedy)),
      where_(std::move(where)),
      problem_(std::move(problem)),
      remedy_(std::move(remedy)) {}

}  // namespace rigfit::signal
