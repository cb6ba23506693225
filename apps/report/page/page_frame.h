// What frames the parts of a report: who made it and for whom, from which inputs.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "apps/campaign_file/report_details.h"

namespace rigfit::apps {

/// Whom the report is for: a client gets the short report and the appendix as a page of its own,
/// a laboratory one page of both.
enum class ReportStyle { lab, client };

struct PageFrame {
  std::string title, source, description;
  ReportDetails details;
  ReportStyle style = ReportStyle::lab;
  std::string version;  ///< version of rigfit
  std::string repeat;   ///< command line that makes the report again
  std::vector<std::pair<std::string, std::string>> inputs;  ///< path, SHA-256
  std::vector<std::pair<std::string, std::string>> links;   ///< other pages: file, title
};

}  // namespace rigfit::apps
