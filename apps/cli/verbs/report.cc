#include "apps/campaign/campaign.h"
#include "apps/cli/verbs/all.h"
#include "apps/report/campaign_report.h"

namespace rigfit::apps {

namespace {

struct ReportCommand {
  std::vector<std::string> campaigns;  ///< one, or two to be compared
  std::string out;
  ReportOptions report;
  std::vector<double> figure_size;  ///< mm
  std::string figure_font = "sans-serif";
  double figure_font_size = 8;  ///< pt
};

describe::Options options_of(ReportCommand& c) {
  return {option("campaign", c.campaigns,
                 "Campaign (TOML); two: before and after, compared value by value")
              .required(),
          option("--out", c.out,
                 "Folder for report.html, report.json, data/ and figures/ [report beside the "
                 "campaign]"),
          choice("--style", c.report.style, {"lab", "client"},
                 "lab: one page of everything; client: a short report, the appendix beside it"),
          option("--pdf", c.report.pdf, "Print to PDF as well, by a Chromium on PATH"),
          option("--force", c.report.force, "Replace another campaign's report in the folder"),
          option("--figure-size", c.figure_size, "Width and height of the figures for a paper, mm")
              .count(2)
              .within(20.0, 1000.0),
          option("--figure-font", c.figure_font, "Font of these figures"),
          option("--figure-font-size", c.figure_font_size, "Its size", "pt").within(4.0, 24.0)};
}

Json run(ReportCommand& c, VerbContext& context) {
  if (c.campaigns.size() > 2) throw UsageError("campaign: one, or two to be compared");
  auto& report = c.report;
  if (!c.figure_size.empty()) {
    report.figures =
        print_size(c.figure_size[0], c.figure_size[1], c.figure_font, c.figure_font_size);
  }
  std::string out = c.out;
  if (out.empty() && c.campaigns.size() > 1) {
    throw UsageError("two campaigns: name the folder of the comparison, --out DIR");
  }
  if (out.empty()) {
    out = (std::filesystem::path(c.campaigns[0]).parent_path() / "report").string();
  }
  std::vector<Campaign> campaigns;
  for (const auto& file : c.campaigns) {
    context.input(file);
    campaigns.push_back(read_campaign(file));
  }
  return campaigns.size() == 1
             ? campaign_report(campaigns[0], out, report, context)
             : compared_campaigns(campaigns[0], campaigns[1], out, report, context);
}

}  // namespace

Verb report_verb() {
  return verb_of<ReportCommand>(
      "report", "Everything a campaign names, from recordings to model against test",
      "Example:\n  rigfit report testdata/jalali2021/campaign.toml --out report\n"
      "  rigfit report spring.toml autumn.toml --out change --pdf",
      run, false, false, report_schema);
}

}  // namespace rigfit::apps
