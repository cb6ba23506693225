#include <fmt/format.h>

#include <memory>

#include "apps/cli/verbs/all.h"
#include "apps/report/campaign_report.h"

namespace rigfit::apps {

void add_report(CLI::App& program, Verbs& verbs) {
  struct Options {
    std::string campaign, out;
  };
  auto options = std::make_shared<Options>();
  CLI::App* app = program.add_subcommand(
      "report", "Everything a campaign names, from recordings to model against test");
  app->add_option("campaign", options->campaign, "Campaign (TOML)")->required();
  app->add_option("--out", options->out, "Folder for report.html, report.json, data/ and figures/")
      ->required()
      ->type_name("DIR");
  app->footer("Example:\n  rigfit report testdata/jalali2021/campaign.toml --out report");
  verbs.push_back({app, [options](VerbContext& context) {
                     context.input(options->campaign);
                     const Campaign campaign = read_campaign(options->campaign);
                     return campaign_report(campaign, options->out, context);
                   }});
}

}  // namespace rigfit::apps
