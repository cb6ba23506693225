// Findings of a run have two levels. A warning asks for something or casts doubt on an answer; a
// note says what was done (a start chosen, a column left out, hits rejected). People read those of
// one kind (code) in one line, those that can change an answer first; on a terminal five lines are
// enough. --verbose, which says notes too, and the JSON document of a verb hold each by itself.
#pragma once

#include <span>

#include "apps/describe/standard.h"
#include "ident/statistics/finding.h"

namespace rigfit::apps {

using ident::Finding;

enum class Level { answer_may_be_wrong, look_at, taken_as_said, note };

[[nodiscard]] Level level_of(std::string_view code);

/// Findings of one code, told once: the first one and where all of them are. A refusal stands by
/// itself.
struct FindingKind {
  Finding first;
  std::vector<std::string> places = {};  ///< each once
  std::size_t count = 1;
  std::string title = {}, anchor = {};  ///< the part of a report that says more

  [[nodiscard]] bool note() const { return !first.refused && level_of(first.code) == Level::note; }
  /// The first four places without their folders.
  [[nodiscard]] std::string listed() const;
};

/// Adds a finding to its kind; gives the kind that it begins, else null.
FindingKind* add(std::vector<FindingKind>& kinds, const Finding& one);
/// Refusals first, then the gravest, then in the order they were said.
void sort_by_level(std::vector<FindingKind>& kinds);

/// Lines without their end: one a kind, of more than five kinds five and one that counts the
/// others; `each`: one a finding.
[[nodiscard]] std::vector<std::string> warning_lines(std::span<const Finding> warnings,
                                                     bool each = false);

}  // namespace rigfit::apps
