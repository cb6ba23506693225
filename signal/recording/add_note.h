// Adds a note whose message is made of its values.
#pragma once

#include <fmt/format.h>

#include "signal/recording/recording.h"

namespace rigfit::signal {

template <typename... Values>
void add_note(std::vector<Note>& notes, std::string code, std::string where,
              fmt::format_string<Values...> message, Values&&... values) {
  notes.push_back(
      {std::move(code), fmt::format(message, std::forward<Values>(values)...), std::move(where)});
}

}  // namespace rigfit::signal
