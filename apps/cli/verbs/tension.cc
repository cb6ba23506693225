// rigfit tension: tension of a cable, hanger or stay from its natural frequencies.

#include "apps/campaign_file/measured_modes.h"
#include "apps/cli/verbs/all.h"
#include "ident/campaign/single_tests/tension_campaign.h"
#include "signal/readers/csv_fields.h"

namespace rigfit::apps {
namespace {

struct TensionCommand {
  std::vector<std::string> files;
  TensionTest test;
};

constexpr const char* kExample =
    "Examples:\n"
    "  rigfit tension --frequencies 7.36 14.59 22.15 29.9 --frequency-std 0.01 --length 2.4 "
    "--mass-per-length 0.16667\n"
    "  rigfit tension ambient.csv --channel acc --band 0.5 20 --length 98.3,0.05 --mass-per-length "
    "62.1,0.5 --EA 1.6e9";

/// "PLACE=KG[,STD]"
void add_mass(const std::string& text, ident::CableDescription& cable) {
  const auto given = named_numbers("--mass-at", text, "PLACE=KG[,STD], such as 0.5=1.2,0.1", 1, 2);
  const double mass = given.numbers[0];
  double place = -1;
  if (!signal::parse_whole_number(given.name, '.', place)) {
    throw UsageError("--mass-at: \"" + given.name + "\" is no place from 0 to 1");
  }
  cable.masses.push_back({place, mass});
  if (given.numbers.size() > 1) {
    cable.masses_std = std::max(cable.masses_std, given.numbers[1] / mass);
  }
}

Json run(TensionCommand& command, VerbContext& context) {
  auto& inputs = command.test;
  if (const auto& file = command.test.measured; !file.empty()) {
    const auto rows = measured_modes(file, command.test.column, inputs.plane, {}, context);
    inputs.modes.assign(rows.begin(), rows.end());
  }
  command.test.complete();
  if (inputs.modes.empty() && command.files.empty()) {
    throw UsageError("give recordings, --measured or --frequencies");
  }
  for (const auto& file : command.files) {
    auto recording = load_recording(file, context);
    inputs.recordings.push_back({recording.path.string(), std::move(recording)});
  }
  const auto campaign = ident::tension_campaign(inputs);
  if (!campaign.modes.empty()) ident::check_cable(inputs.cable, campaign.modes);
  const auto& result = campaign.tension;
  auto findings = campaign.findings;
  if (!result.solved) std::erase_if(findings, [](const auto& f) { return f.code == "no_tension"; });
  context.tell(findings);
  if (!result.solved) {
    throw Refused(result.message, campaign.modes.empty() ? "no_modes" : "no_tension");
  }
  describe::print(context.out, describe::sheet_of(result));
  if (context.plots) context.plots->add(tension_blocks("tension", result));
  return describe::json_of(campaign);
}

describe::Options options_of(TensionCommand& c) {
  describe::Options options{
      option("FILE", c.files, "Recordings of the cable's motion: its modes").once()};
  for (auto& key : as_command_line(keys_of(c.test))) {
    if (key.name == "--channels") key.name = "--channel";
    if (key.name == "--orders") key.name = "--order";
    options.push_back(std::move(key));
  }
  options.push_back(converted(
                        "--mass-at", [&c](const auto& text) { add_mass(text, c.test.cable); },
                        "Masses or clamps on the cable: place from 0 to 1 of its length, kg "
                        "(the largest relative std counts for all)",
                        describe::Kind::texts)
                        .type("PLACE=KG[,STD]"));
  return options;
}

}  // namespace

Verb tension_verb() {
  return verb_of<TensionCommand>(
      "tension", "Tension of a cable, hanger or stay from its frequencies", kExample, run, true,
      true, describe::schema_of<ident::TensionCampaignResult>);
}

}  // namespace rigfit::apps
