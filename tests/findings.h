// Whether one of a list of notes or findings has a code.
#pragma once

#include <algorithm>
#include <string_view>

namespace rigfit::testing {

template <typename List>
bool says(const List& list, std::string_view code) {
  return std::any_of(list.begin(), list.end(), [&](const auto& one) { return one.code == code; });
}

}  // namespace rigfit::testing
