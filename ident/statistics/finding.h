// Warnings and refusals that accompany the numbers of an analysis.
#pragma once

#include "ident/statistics/numbers.h"
#include "signal/recording/recording.h"

namespace rigfit::ident {

using Finding = signal::Note;

/// Adds notes; `where`: instead of their places.
inline void add_notes(const std::vector<signal::Note>& notes, std::vector<Finding>& findings,
                      const std::string& where = {}) {
  for (const auto& note : notes) {
    findings.push_back(note);
    if (!where.empty()) findings.back().where = where;
  }
}

}  // namespace rigfit::ident
