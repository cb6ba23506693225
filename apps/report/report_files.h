// What a report leaves in its folder: pages, figures, data, tables for papers, files for other
// programs.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "apps/cli/verb.h"
#include "apps/report/drawing/svg_plot.h"
#include "apps/report/page/report_page.h"

namespace rigfit::apps {

struct ReportOptions {
  ReportStyle style = ReportStyle::lab;
  bool pdf = false;    ///< report.pdf (and appendix.pdf) beside the page
  SvgOptions figures;  ///< size and font of the figures for papers
  bool force = false;  ///< another campaign's report in the folder may be replaced
};

/// Throws UsageError when `folder` holds a report of another title: of another campaign.
void require_own_report(const std::filesystem::path& folder, const std::string& title);

/// All figures of the parts that have data, for the document: id, title, data, figure.
[[nodiscard]] Json figure_list(std::span<const ReportPart> parts);

/// Every answer of the parts, in their order.
[[nodiscard]] std::vector<Answer> all_answers(std::span<const ReportPart> parts);

/// Writes everything but report.json, of which `document` is the text, made beside the figures.
/// `parts`: the overview first.
void write_report_files(const std::filesystem::path& folder, const PageFrame& frame,
                        std::span<const ReportPart> parts, const ReportOptions& options,
                        const std::function<std::string()>& document, VerbContext& context);

}  // namespace rigfit::apps
