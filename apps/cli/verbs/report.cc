#include <fmt/format.h>

#include <memory>

#include "apps/cli/verbs/all.h"
#include "apps/report/campaign_report.h"

namespace rigfit::apps {

void add_report(CLI::App& program, Verbs& verbs) {
  struct Options {
    std::vector<std::string> campaigns;
    std::string out, style = "lab";
    bool pdf = false, force = false;
    std::vector<double> figure_size;  // mm
    std::string figure_font = "sans-serif";
    double figure_font_size = 8;  // pt
  };
  auto options = std::make_shared<Options>();
  CLI::App* app = program.add_subcommand(
      "report", "Everything a campaign names, from recordings to model against test");
  app->add_option("campaign", options->campaigns,
                  "Campaign (TOML); two: before and after, compared value by value")
      ->required()
      ->expected(1, 2);
  app->add_option("--out", options->out, "Folder for report.html, report.json, data/ and figures/")
      ->required()
      ->type_name("DIR");
  app->add_option("--style", options->style,
                  "lab: one page of everything; client: a short report, the appendix beside it")
      ->check(CLI::IsMember({"lab", "client"}))
      ->capture_default_str();
  app->add_flag("--pdf", options->pdf, "Print to PDF as well, by a Chromium on PATH");
  app->add_flag("--force", options->force, "Replace another campaign's report in the folder");
  app->add_option("--figure-size", options->figure_size,
                  "Width and height of the figures for a paper, mm; with --pdf also figures.pdf")
      ->expected(2)
      ->check(CLI::Range(20.0, 1000.0))
      ->type_name("MM MM");
  app->add_option("--figure-font", options->figure_font, "Font of these figures")
      ->capture_default_str();
  app->add_option("--figure-font-size", options->figure_font_size, "Its size, pt")
      ->check(CLI::Range(4.0, 24.0))
      ->type_name("PT")
      ->capture_default_str();
  app->footer(
      "Example:\n  rigfit report testdata/jalali2021/campaign.toml --out report\n"
      "  rigfit report spring.toml autumn.toml --out change --pdf");
  verbs.push_back({app, [options](VerbContext& context) {
                     ReportOptions report;
                     if (options->style == "client") report.style = ReportStyle::client;
                     report.pdf = options->pdf;
                     report.force = options->force;
                     if (!options->figure_size.empty()) {
                       report.figures = print_size(options->figure_size[0], options->figure_size[1],
                                                   options->figure_font, options->figure_font_size);
                     }
                     std::vector<Campaign> campaigns;
                     for (const auto& file : options->campaigns) {
                       context.input(file);
                       campaigns.push_back(read_campaign(file));
                     }
                     return campaigns.size() == 1
                                ? campaign_report(campaigns[0], options->out, report, context)
                                : compared_campaigns(campaigns[0], campaigns[1], options->out,
                                                     report, context);
                   }});
}

}  // namespace rigfit::apps
