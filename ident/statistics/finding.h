// Warnings and refusals that accompany the numbers of an analysis.
#pragma once

#include <initializer_list>

#include "ident/statistics/numbers.h"
#include "signal/recording/recording.h"

namespace rigfit::ident {

using Finding = signal::Note;

/// Adds notes as warnings, those of `refused` codes as refusals; `where`: instead of their places.
inline void add_notes(const std::vector<signal::Note>& notes, std::vector<Finding>& findings,
                      const std::string& where = {},
                      std::initializer_list<std::string_view> refused = {}) {
  for (const auto& note : notes) {
    findings.push_back({note.code, note.message, where.empty() ? note.where : where,
                        std::ranges::count(refused, note.code) > 0});
  }
}

}  // namespace rigfit::ident
