// rigfit tension: tension of a cable, hanger or stay from its natural frequencies.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include "apps/campaign/campaign.h"
#include "apps/campaign_file/measured_modes.h"
#include "apps/campaign_file/recording_description.h"
#include "apps/cli/named_numbers.h"
#include "apps/cli/plots/plot_option.h"
#include "apps/cli/verbs/all.h"
#include "apps/describe/sheet.h"
#include "apps/report/figures/figures.h"
#include "apps/results/results_json.h"
#include "apps/results/text_table.h"
#include "document/document_error.h"
#include "document/toml_table.h"
#include "ident/campaign/single_tests/tension_campaign.h"
#include "ident/statistics/in_parallel.h"
#include "model/scene/scene_error.h"
#include "signal/readers/csv/csv_fields.h"

namespace rigfit::apps {
namespace {

struct TensionCommand {
  std::vector<std::string> files;
  TensionTest test;
  std::vector<std::string> masses;  ///< "PLACE=KG[,STD]"
  std::string table, out;           ///< many cables, a row each
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

struct CableTableRow {
  long line = 0;
  ident::TensionInputs test;
  std::string error;  ///< why the row cannot be used; empty: it can
};

/// A row a cable: name, length, mass_per_length and, of a campaign's tension test, any other key,
/// with frequencies in columns f1, f2 ... or several in one cell "frequencies" (ident/tension). A
/// row that cannot be used is named with its line and reason; the others are read all the same.
class CableRows {
 public:
  explicit CableRows(const std::filesystem::path& path) : table_(read_text_table(path)) {
    const auto fail = [&](const std::string& problem, const char* remedy) {
      throw model::SceneError({table_.file, table_.header_line, 0, ""}, problem, remedy);
    };
    for (const char* needed : {"length", "mass_per_length"}) {
      if (table_.find(needed) >= 0) continue;
      fail(fmt::format("no column \"{}\"", needed),
           "a table of cables has name, length, mass_per_length and f1, f2 ...");
    }
    for (std::size_t i = 0; i < table_.columns.size(); ++i) {
      const auto& name = table_.columns[i].name;
      if (name.size() > 1 && name[0] == 'f' &&
          name.find_first_not_of("0123456789", 1) == std::string::npos) {
        frequencies_.push_back(i);
      }
    }
    if (frequencies_.empty() && table_.find("frequencies") < 0) {
      fail("no column of frequencies",
           "name them f1, f2 ..., or put them into one column \"frequencies\"");
    }
    if (table_.rows.empty())
      throw model::SceneError({table_.file, 0, 0, ""}, "no cable", "write one a row");
  }

  [[nodiscard]] std::vector<CableTableRow> read() const {
    std::vector<CableTableRow> rows;
    std::set<std::string> taken;
    for (const auto& row : table_.rows) {
      CableTableRow one;
      one.line = row.line;
      std::string name = table_.text(row, table_.find("name") >= 0 ? "name" : "cable");
      if (name.empty()) name = fmt::format("line {}", row.line);
      try {
        if (!taken.insert(name).second) throw std::invalid_argument("the name is taken");
        one.test = test_of(row);
      } catch (const document::DocumentError& error) {
        one.error = error.where().key + " " + error.problem();
      } catch (const std::exception& error) {
        one.error = error.what();
      }
      one.test.name = std::move(name);
      rows.push_back(std::move(one));
    }
    return rows;
  }

 private:
  /// The row as the keys of a campaign's tension test; what is blank keeps its default.
  [[nodiscard]] ident::TensionInputs test_of(const TextTable::Row& row) const {
    TensionTest test;
    const auto keys = keys_of(test);
    std::string text;
    for (const auto& key : keys) {
      std::string cell = table_.text(row, key.name == "orders" ? "order" : key.name);
      if (std::holds_alternative<std::vector<double>*>(key.target)) {
        if (key.name == "frequencies") {
          for (const std::size_t column : frequencies_) {
            const double hz = table_.number(row, column);
            if (std::isfinite(hz)) cell += fmt::format(" {}", hz);
          }
        }
        std::istringstream words(cell);
        std::string list;
        for (std::string word; words >> word;) list += (list.empty() ? "" : ", ") + word;
        cell = list.empty() ? "" : "[" + list + "]";
      } else if (std::holds_alternative<std::string*>(key.target)) {
        if (!cell.empty()) cell = "'" + cell + "'";
      } else {
        const double value = table_.number(row, key.name);
        cell = std::isfinite(value) ? fmt::format("{}", value) : "";
      }
      if (!cell.empty()) text += key.name + " = " + cell + "\n";
    }
    auto toml = document::TomlTable::parse(text, "");
    read_keys(toml, keys);
    test.complete();
    if (test.inputs.modes.empty()) throw std::invalid_argument("no frequency");
    return std::move(test.inputs);
  }

  TextTable table_;
  std::vector<std::size_t> frequencies_;
};

/// One row a cable: its result, or why there is none; a refused or unreadable row ends the run with
/// exit code 4, after all others.
Json table_of_cables(const TensionCommand& command, VerbContext& context) {
  context.input(command.table);
  const auto rows = CableRows(command.table).read();
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
    Json& json = cables.emplace_back(Json{{"name", row.test.name}, {"line", row.line}});
    if (!row.error.empty()) {
      const auto where = fmt::format("{}:{}", command.table, row.line);
      context.refuse("bad_row", row.test.name + ": " + row.error, where);
      json["error"] = row.error;
      continue;
    }
    const auto& one = results[next++];
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
      option("FILE", c.files, "Recordings of the cable's motion: its modes"),
      option("--table", c.table, "Many cables, a row each (columns: ident/tension/README.md)"),
      option("--out", c.out, "Table of the tensions of --table").writes()};
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
