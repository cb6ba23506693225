// rigfit tension: tension of a cable, hanger or stay from its natural frequencies.

#include <set>
#include <stdexcept>

#include "apps/campaign_file/measured_modes.h"
#include "apps/cli/verbs/all.h"
#include "apps/results/text_table.h"
#include "document/document_error.h"
#include "ident/campaign/single_tests/tension_campaign.h"
#include "ident/statistics/in_parallel.h"
#include "signal/readers/csv/csv_fields.h"

namespace rigfit::apps {
namespace {

struct TensionCommand {
  std::vector<std::string> files;
  TensionTest test;
  std::string table, out;  ///< many cables, a row each
};

constexpr const char* kExample =
    "Examples:\n"
    "  rigfit tension --frequencies 7.36 14.59 22.15 29.9 --frequency-std 0.01 --length 2.4 "
    "--mass-per-length 0.16667\n"
    "  rigfit tension ambient.csv --channel acc --band 0.5 20 --length 98.3,0.05 --mass-per-length "
    "62.1,0.5 --EA 1.6e9\n"
    "  rigfit tension --table cables.csv --out tensions.csv --json tensions.json";

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

struct CableTableRow {
  long line = 0;
  ident::TensionInputs test;
  std::string error;  ///< why the row cannot be used; empty: it can
  ident::TensionCampaignResult found = {};
};

/// A row a cable: its name and the keys of a campaign's tension test, with frequencies in columns
/// f1, f2 ... or several in one cell "frequencies" (ident/tension). A row that cannot be used is
/// named with its line and reason; the others are read all the same.
std::vector<CableTableRow> read_cables(const std::string& path) {
  const TextTable table = read_text_table(path);
  std::vector<std::size_t> frequencies;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const auto& name = table.columns[i].name;
    const bool numbered = name.find_first_not_of("0123456789", 1) == std::string::npos;
    if (name.size() > 1 && name[0] == 'f' && numbered) frequencies.push_back(i);
  }
  std::vector<CableTableRow> rows;
  std::set<std::string> taken;
  for (const auto& row : table.rows) {
    std::string name = table.text(row, table.find("name") >= 0 ? "name" : "cable");
    if (name.empty()) name = fmt::format("line {}", row.line);
    TensionTest test;
    auto keys = keys_of(test);
    for (auto& key : keys) {
      if (key.name == "orders") key.name = "order";
    }
    std::string error;
    try {
      if (!taken.insert(name).second) throw std::invalid_argument("the name is taken");
      fill_row(table, row, keys, {{"frequencies", frequencies}});
      test.complete();
      if (test.inputs.modes.empty()) throw std::invalid_argument("no frequency");
    } catch (const document::DocumentError& wrong) {
      error = wrong.where().key + " " + wrong.problem();
    } catch (const std::invalid_argument& wrong) {
      error = wrong.what();
    }
    test.inputs.name = std::move(name);
    rows.push_back({row.line, std::move(test.inputs), std::move(error)});
  }
  return rows;
}

/// One row a cable: its result, or why there is none; a refused or unreadable row ends the run with
/// exit code 4, after all others.
Json table_of_cables(const TensionCommand& command, VerbContext& context) {
  context.input(command.table);
  auto rows = read_cables(command.table);
  ident::in_parallel(rows.size(), context.threads, [&](std::size_t i) {
    auto& [line, test, error, found] = rows[i];
    test.options.missed = command.test.inputs.options.missed;
    test.options.false_mode = command.test.inputs.options.false_mode;
    if (error.empty()) found = ident::tension_campaign(test);
  });
  describe::Table table{
      "", {"cable", "tension, N", "95 % interval", "ends"}, {false, true, true, false}, {}};
  std::string out = "name,tension_N,std_N,low_N,high_N,start_N,end_N,EI_Nm2,ends,decided\n";
  Json cables = Json::array();
  for (const auto& row : rows) {
    Json& json = cables.emplace_back(Json{{"name", row.test.name}, {"line", row.line}});
    if (!row.error.empty()) {
      const auto where = fmt::format("{}:{}", command.table, row.line);
      context.refuse("bad_row", row.test.name + ": " + row.error, where);
      json["error"] = row.error;
      continue;
    }
    const auto& one = row.found;
    context.tell(one.findings);
    if (!one.tension.solved) {
      json["error"] = one.tension.message;
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
  if (const auto& file = command.test.measured; !file.empty()) {
    context.input(file);
    for (auto& row : read_measured_modes(file, command.test.column, inputs.plane, {})) {
      inputs.modes.push_back(std::move(row.mode));
    }
  }
  command.test.complete();
  if (inputs.modes.empty() && command.files.empty()) {
    throw UsageError("give recordings, --measured or --frequencies");
  }
  for (const auto& file : command.files) {
    auto recording = load_recording(file, context);
    const std::string name = recording.path.string();
    inputs.recordings.push_back({name, std::move(recording)});
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
  describe::Options options{
      option("FILE", c.files, "Recordings of the cable's motion: its modes"),
      option("--table", c.table, "Many cables, a row each (columns: ident/tension/README.md)"),
      option("--out", c.out, "Table of the tensions of --table").writes()};
  for (auto& key : as_command_line(keys_of(c.test))) {
    key.is_required = false;  // --table has its own
    if (key.name == "--channels") key.name = "--channel";
    if (key.name == "--orders") key.name = "--order";
    options.push_back(std::move(key));
  }
  options.push_back(converted(
                        "--mass-at",
                        [&c](const auto& text) { add_mass(text, c.test.inputs.cable); },
                        "Masses or clamps on the cable: place from 0 to 1 of its length, kg "
                        "(the largest relative std counts for all)",
                        describe::Kind::texts)
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
