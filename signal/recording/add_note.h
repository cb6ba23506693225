// Adds a note (or, in ident, a finding) whose message is made of its values.
#pragma once

#include <fmt/format.h>

#include "signal/recording/recording.h"

namespace rigfit::signal {

template <typename Noted, typename... Values>
void add_note(std::vector<Noted>& notes, std::string code, std::string where,
              fmt::format_string<Values...> message, Values&&... values) {
  notes.push_back(
      {std::move(code), fmt::format(message, std::forward<Values>(values)...), std::move(where)});
}

}  // namespace rigfit::signal
