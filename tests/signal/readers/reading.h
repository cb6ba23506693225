// What tests of readers ask of notes and refusals.
#pragma once

#include "signal/recording/recording.h"
#include "tests/test.h"

namespace rigfit::signal {

inline std::vector<std::string> codes(const std::vector<Note>& notes) {
  std::vector<std::string> out;
  for (const auto& note : notes) out.push_back(note.code);
  return out;
}

/// What `read` throws, which must say what to do; a failure when it throws nothing.
template <typename Read>
RecordingError error_of(Read&& read) {
  try {
    (void)read();
  } catch (const RecordingError& error) {
    EXPECT_FALSE(error.remedy().empty());
    return error;
  }
  ADD_FAILURE() << "read without a word";
  return {{}, "", ""};
}

template <typename Read>
std::string refusal_of(Read&& read) {
  return error_of(read).what();
}

}  // namespace rigfit::signal
