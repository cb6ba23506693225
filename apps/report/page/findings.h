// What the parts of a report found, as it is told: each kind (code) once with all its places, what
// can change an answer first. A warning asks for something or casts doubt on an answer; a note is
// normal operation, or allowed for in the values.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "apps/report/page/report_part.h"

namespace rigfit::apps {

struct ReportFinding {
  std::string code, message;  ///< code and message of the first of its kind
  std::string where;          ///< places, the first ones by name
  std::string title, anchor;  ///< title and anchor of the part that says more
  std::size_t count = 1;      ///< number of findings of its kind
  bool refused = false, note = false;
};

/// Refusals stand each by itself.
[[nodiscard]] std::vector<ReportFinding> findings_of(std::span<const ReportPart> parts);

/// Items of a list on the page.
[[nodiscard]] std::string findings_html(std::span<const ReportFinding> findings);

}  // namespace rigfit::apps
