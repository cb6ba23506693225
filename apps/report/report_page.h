// A report as one HTML page that needs nothing else: style, scripts, data and pictures are in it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "apps/report/report_part.h"

namespace rigfit::apps {

struct PageFrame {
  std::string title, source, description;
  std::string version;  ///< of rigfit
  std::string repeat;   ///< command line that makes the report again
  std::vector<std::pair<std::string, std::string>> inputs;  ///< path, SHA-256
  std::vector<PartWarning> warnings;
};

[[nodiscard]] std::string report_page(const PageFrame& frame, const std::vector<ReportPart>& parts);

}  // namespace rigfit::apps
