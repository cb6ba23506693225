// rigfit bending: EI at each tension from load-deflection records, and laws for EI over tension.

#include "apps/campaign_file/bending_files.h"
#include "apps/cli/verbs/all.h"
#include "ident/campaign/single_tests/bending_campaign.h"

namespace rigfit::apps {
namespace {

struct BendingCommand {
  std::vector<std::string> files;
  BendingTest test;            ///< its channel of tension "0": a beam without
  std::vector<double> strand;  ///< E, elements, element diameter, strand diameter
};

Json run(BendingCommand& command, VerbContext& context) {
  auto& campaign = command.test;
  if (campaign.channels.tension == "0") {
    campaign.tension_N = 0;
  } else if (campaign.ends != BendingTest().ends || campaign.section.second_moment().value > 0) {
    throw UsageError("--ends and a cross-section belong to a beam without tension: --tension 0");
  }
  campaign.complete();
  for (const auto& file : command.files) {
    std::vector<Finding> warnings;
    campaign.sources.push_back(bending_source(load_bending_file(file, context),
                                              {campaign.channels, campaign.beam()}, warnings));
    if (campaign.sources.back().values.empty() && !(campaign.test.span_m.value > 0)) {
      throw UsageError(
          "--span is needed for load-deflection records: the clear length between the clamps in "
          "metres");
    }
    context.tell(warnings);
  }
  if (!command.strand.empty()) {
    campaign.strand = {command.strand[0], static_cast<int>(command.strand[1]), command.strand[2],
                       command.strand[3]};
  }
  const auto found = ident::analyse_bending_campaign(campaign);
  context.tell(found.findings);
  if (context.plots) context.plots->add(bending_blocks("bending", campaign, found));
  describe::print(context.out, describe::sheet_of(found));
  return describe::json_of(found);
}

describe::Options options_of(BendingCommand& c) {
  describe::Options options{
      option("FILE", c.files,
             "Records or tables with tension, load and deflection, or tables of tension and EI "
             "(with std, or low and high)")
          .once()
          .required()
          .file(),
      option("--load", c.test.channels.load, "Name of the load column"),
      option("--deflection", c.test.channels.deflection, "Name of the deflection column"),
      option("--strand", c.strand,
             "Young's modulus (Pa), number of wires, wire diameter (m), strand diameter (m): "
             "bounds on EI")
          .count(4)
          .positive(),
      option("--relative-std", c.test.assumed_relative_std,
             "Relative standard uncertainty of EI values that come without one")
          .within(0.0, 1.0)};
  for (auto& key : as_command_line(keys_of(c.test))) {
    key.is_required = false;  // tables of EI have no span
    if (key.name == "--tension") {
      key = option("--tension", c.test.channels.tension,
                   "Name of the tension column; 0: there is no tension (a beam, by dead weights or "
                   "a testing machine)");
    }
    options.push_back(std::move(key));
  }
  return options;
}

}  // namespace

Verb bending_verb() {
  return verb_of<BendingCommand>(
      "bending", "EI at each tension from load-deflection records or tables; laws for EI(tension)",
      "Example:\n  printf 'tension_N,EI_Nm2\\n25,0.2549\\n100,0.4948\\n200,0.5972\\n300,0.8283\\n' "
      "> "
      "ei.csv\n  rigfit bending ei.csv --strand 195e9 133 0.397e-3 6.35e-3 --json ei.json",
      run, true, true, describe::schema_of<ident::BendingCampaignResult>);
}

}  // namespace rigfit::apps
