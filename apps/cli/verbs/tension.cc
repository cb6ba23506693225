// rigfit tension: tension of a cable, hanger or stay from its natural frequencies.
#include <fmt/format.h>

#include <algorithm>

#include "apps/campaign/campaign.h"
#include "apps/campaign_file/cable_table.h"
#include "apps/campaign_file/measured_modes.h"
#include "apps/campaign_file/recording_description.h"
#include "apps/cli/named_numbers.h"
#include "apps/cli/plots/plot_option.h"
#include "apps/cli/verbs/all.h"
#include "apps/describe/sheet.h"
#include "apps/report/figures/figures.h"
#include "apps/results/results_json.h"
#include "ident/campaign/single_tests/tension_campaign.h"
#include "ident/statistics/in_parallel.h"
#include "signal/readers/csv/csv_fields.h"

namespace rigfit::apps {
namespace {

struct TensionCommand {
  std::vector<std::string> files;
  TensionTest test;
  std::vector<std::string> masses;  ///< "PLACE=KG[,STD]"
  std::string table, out;           ///< many cables, a row each (campaign_file/cable_table.h)
};

constexpr const char* kExample =
    "Examples:\n"
    "  rigfit tension --frequencies 7.36 14.59 22.15 29.9 --frequency-std 0.01 --length 2.4 "
    "--mass-per-length 0.16667\n"
    "  rigfit tension ambient.csv --channel acc --band 0.5 20 --length 98.3,0.05 --mass-per-length "
    "62.1,0.5 --EA 1.6e9\n"
    "  rigfit tension --table cables.csv --out tensions.csv --json tensions.json";

void add_masses(const std::vector<std::string>& texts, ident::CableDescription& cable) {
  for (const std::string& text : texts) {
    const auto given =
        named_numbers("--mass-at", text, "PLACE=KG[,STD], such as 0.5=1.2,0.1", 1, 2);
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
}

/// One row a cable: its result, or why there is none; a refused or unreadable row ends the run with
/// exit code 4, after all others.
Json table_of_cables(const TensionCommand& command, VerbContext& context) {
  context.input(command.table);
  const auto rows = read_cable_table(command.table);
  std::vector<ident::TensionInputs> tests;
  for (const auto& row : rows) {
    if (!row.error.empty()) continue;
    tests.push_back(row.test);
    auto& options = tests.back().options;
    options.missed = command.test.inputs.options.missed;
    options.false_mode = command.test.inputs.options.false_mode;
  }
  std::vector<ident::TensionCampaignResult> results(tests.size());
  ident::in_parallel(tests.size(), context.threads,
                     [&](std::size_t i) { results[i] = ident::tension_campaign(tests[i]); });
  describe::Table table{
      "", {"cable", "tension, N", "95 % interval", "ends"}, {false, true, true, false}, {}};
  std::string out = "name,tension_N,std_N,low_N,high_N,start_N,end_N,EI_Nm2,ends,decided\n";
  Json cables = Json::array();
  std::size_t next = 0;
  for (const auto& row : rows) {
    Json json{{"name", row.test.name}, {"line", row.line}};
    if (!row.error.empty()) {
      const auto where = fmt::format("{}:{}", command.table, row.line);
      context.refuse("bad_row", row.test.name + ": " + row.error, where);
      json["error"] = row.error;
      cables.push_back(std::move(json));
      continue;
    }
    const auto& one = results[next++];
    context.tell(one.findings);
    if (!one.tension.solved) {
      json["error"] = one.tension.message;
      cables.push_back(std::move(json));
      continue;
    }
    json.update(describe::json_of(one.tension));
    const auto& T = one.tension.tension_N;
    const char* ends = ident::name_of(one.tension.candidates.front().ends);
    table.rows.push_back({row.test.name, describe::estimate_text(T.value, T.std, "N"),
                          describe::ends_text({one.tension.low, one.tension.high, T.std}, "N"),
                          ends});
    out += fmt::format("\"{}\",{:.8g},{:.4g},{:.8g},{:.8g},{:.8g},{:.8g},{:.6g},{},{}\n",
                       row.test.name, T.value, T.std, one.tension.low, one.tension.high,
                       one.tension.start_N, one.tension.end_N, one.tension.EI_Nm2.value, ends,
                       one.tension.decided ? "yes" : "no");
    cables.push_back(std::move(json));
  }
  describe::print(context.out, table);
  if (!command.out.empty()) context.write(command.out, out);
  return Json{{"cables", std::move(cables)}};
}

Json one_cable(TensionCommand command, VerbContext& context) {
  auto& inputs = command.test.inputs;
  auto& cable = inputs.cable;
  if (!(cable.length_m.value > 0 && cable.mass_per_length.value > 0)) {
    throw UsageError("give --length and --mass-per-length, or --table");
  }
  add_masses(command.masses, cable);
  if (const auto& file = command.test.measured; !file.empty()) {
    context.input(file);
    const auto plane = plane_named(command.test.plane);
    for (auto& row : read_measured_modes(file, command.test.column, plane, {})) {
      inputs.modes.push_back(std::move(row.mode));
    }
  }
  try {
    command.test.complete();
  } catch (const std::invalid_argument& error) {
    throw UsageError(std::string("--order ") + error.what());
  }
  if (inputs.modes.empty() && command.files.empty()) {
    throw UsageError("give recordings, --measured or --frequencies");
  }
  for (const auto& file : command.files) {
    auto recording = load_recording(file, context);
    const std::string name = recording.path.string();
    inputs.recordings.push_back({name, std::move(recording)});
  }
  const auto campaign = ident::tension_campaign(inputs);
  if (!campaign.modes.empty()) {
    try {
      ident::check_cable(inputs.cable, campaign.modes);
    } catch (const std::invalid_argument& error) {
      throw UsageError(error.what());
    }
  }
  const auto& result = campaign.tension;
  auto findings = campaign.findings;
  if (!result.solved) std::erase_if(findings, [](const auto& f) { return f.code == "no_tension"; });
  context.tell(findings);
  if (!result.solved) {
    throw Refused(result.message, campaign.modes.empty() ? "no_modes" : "no_tension");
  }
  describe::print(context.out, describe::sheet_of(result));
  if (context.plots) context.plots->add(tension_blocks("tension", result));
  return tension_json(campaign);
}

Json run(TensionCommand& command, VerbContext& context) {
  if (command.table.empty()) return one_cable(command, context);
  const auto& test = command.test;
  if (!command.files.empty() || !test.measured.empty() || !test.frequencies_hz.empty() ||
      test.inputs.cable.length_m.value > 0 || test.inputs.cable.mass_per_length.value > 0) {
    throw UsageError("--table brings lengths, masses and frequencies of its own");
  }
  return table_of_cables(command, context);
}

describe::Options options_of(TensionCommand& c) {
  using describe::option;
  describe::Options options{
      option("files", c.files, "Recordings of the cable's motion: its modes").type("FILE"),
      option("--table", c.table, "Many cables, a row each (columns: ident/tension/README.md)")
          .type("CABLES.csv"),
      option("--out", c.out, "Table of the tensions of --table").writes().type("F.csv")};
  for (auto& key : as_command_line(keys_of(c.test))) {
    key.is_required = false;  // --table has its own
    if (key.name == "--channels") key.name = "--channel";
    if (key.name == "--orders") key.name = "--order";
    options.push_back(std::move(key));
  }
  options.push_back(option("--mass-at", c.masses,
                           "Masses or clamps on the cable: place from 0 to 1 of its length, kg "
                           "(the largest relative std counts for all)")
                        .type("PLACE=KG[,STD]"));
  return options;
}

}  // namespace

Verb tension_verb() {
  return verb_of<TensionCommand>("tension",
                                 "Tension of a cable, hanger or stay from its frequencies",
                                 kExample, run, true, true);
}

}  // namespace rigfit::apps
