// rigfit tension: tension of a cable, hanger or stay from its natural frequencies.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "apps/campaign_file/cable_table.h"
#include "apps/campaign_file/measured_modes.h"
#include "apps/campaign_file/recording_description.h"
#include "apps/cli/json_document.h"
#include "apps/cli/plots/verb_figures.h"
#include "apps/cli/verbs/all.h"
#include "apps/describe/digits.h"
#include "apps/results/tension_result.h"
#include "ident/campaign/single_tests/tension_campaign.h"

namespace rigfit::apps {
namespace {

struct TensionCommand {
  std::vector<std::string> files, channels;
  std::vector<double> frequencies, band;
  std::string measured, column, plane = "any", length, mass, EI, EA, mass_of, ends = "compare";
  double frequency_std = 0, inclination = 0, sample_rate_hz = 0, missed = 0.1, false_mode = 0.05;
  int max_peaks = 12;
  std::vector<double> orders;       ///< whole numbers, one for each of `frequencies`
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

/// "V" or "V,STD".
signal::Estimate value_and_std(const std::string& text, const std::string& option) {
  signal::Estimate estimate{0, 0};
  try {
    std::size_t used = 0;
    estimate.value = std::stod(text, &used);
    if (used < text.size() && text[used] == ',') {
      const std::string rest = text.substr(used + 1);
      estimate.std = std::stod(rest, &used);
      if (used == rest.size() && std::isfinite(estimate.value) && estimate.std >= 0 &&
          std::isfinite(estimate.std)) {
        return estimate;
      }
    } else if (used == text.size() && std::isfinite(estimate.value)) {
      return estimate;
    }
  } catch (const std::exception&) {
  }
  throw UsageError(fmt::format("{}: write a value or VALUE,STD, not \"{}\"", option, text));
}

std::optional<model::ModePlane> plane_of(const TensionCommand& command) {
  if (command.plane == "in") return model::ModePlane::in;
  if (command.plane == "out") return model::ModePlane::out;
  return std::nullopt;
}

std::vector<ident::MeasuredMode> measured_modes(const TensionCommand& command,
                                                VerbContext& context) {
  std::vector<ident::MeasuredMode> modes;
  if (!command.measured.empty()) {
    context.input(command.measured);
    for (auto& row : read_measured_modes(command.measured, command.column, plane_of(command), {})) {
      modes.push_back(std::move(row.mode));
    }
  }
  if (!command.orders.empty() && command.orders.size() != command.frequencies.size()) {
    throw UsageError("--order needs one number for each of --frequencies");
  }
  for (std::size_t i = 0; i < command.frequencies.size(); ++i) {
    ident::MeasuredMode mode;
    if (!command.orders.empty()) {
      mode.order = static_cast<int>(std::lround(command.orders[i]));
      if (mode.order != command.orders[i]) throw UsageError("--order takes whole numbers");
    }
    mode.frequency_hz = {command.frequencies[i],
                         command.frequency_std > 0 ? command.frequency_std : std::nan("")};
    mode.plane = plane_of(command);
    modes.push_back(std::move(mode));
  }
  return modes;
}

ident::CableDescription description_of(const TensionCommand& command) {
  ident::CableDescription cable;
  cable.length_m = value_and_std(command.length, "--length");
  cable.mass_per_length = value_and_std(command.mass, "--mass-per-length");
  if (!command.EI.empty()) cable.EI_Nm2 = value_and_std(command.EI, "--EI");
  if (!command.EA.empty()) cable.EA_N = value_and_std(command.EA, "--EA");
  if (command.mass_of == "installed") cable.mass_reference = ident::MassReference::installed;
  if (command.mass_of == "unstretched") cable.mass_reference = ident::MassReference::unstretched;
  cable.inclination_deg = command.inclination;
  for (const std::string& text : command.masses) {
    const auto equals = text.find('=');
    if (equals == std::string::npos) {
      throw UsageError(
          fmt::format("--mass-at: write PLACE=KG or PLACE=KG,STD (0.5=1.2,0.1), not \"{}\"", text));
    }
    const double place = value_and_std(text.substr(0, equals), "--mass-at").value;
    const auto mass = value_and_std(text.substr(equals + 1), "--mass-at");
    cable.masses.push_back({place, mass.value});
    cable.masses_std = std::max(cable.masses_std, mass.std / mass.value);
  }
  return cable;
}

/// One row a cable: its result, or why there is none; a refused or unreadable row ends the run with
/// exit code 4, after all others.
Json table_of_cables(const TensionCommand& command, VerbContext& context) {
  context.input(command.table);
  const auto rows = read_cable_table(command.table);
  std::vector<ident::CableTest> tests;
  for (const auto& row : rows) {
    if (!row.error.empty()) continue;
    tests.push_back(row.test);
    auto& options = tests.back().options;
    options.missed = command.missed;
    options.false_mode = command.false_mode;
  }
  const auto results = ident::analyse_cable_tests(tests, context.threads);
  context.out << fmt::format("{:<20} {:>14} {:>10} {:>28}  {}\n", "cable", "tension, N", "std",
                             "95 % interval", "ends");
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
    json.update(tension_json(one.tension));
    const auto& T = one.tension.tension_N;
    const char* ends = ident::name_of(one.tension.candidates.front().ends);
    context.out << fmt::format(
        "{:<20} {:>14} {:>10} {:>28}  {}\n", one.name, value_digits(T.value, T.std),
        std_digits(T.std),
        value_digits(one.tension.low, T.std) + " to " + value_digits(one.tension.high, T.std),
        ends);
    out += fmt::format("\"{}\",{:.8g},{:.4g},{:.8g},{:.8g},{:.8g},{:.8g},{:.6g},{},{}\n", one.name,
                       T.value, T.std, one.tension.low, one.tension.high, one.tension.start_N,
                       one.tension.end_N, one.tension.EI_Nm2.value, ends,
                       one.tension.decided ? "yes" : "no");
    cables.push_back(std::move(json));
  }
  if (!command.out.empty()) context.write(command.out, out);
  return Json{{"cables", std::move(cables)}};
}

Json one_cable(const TensionCommand& command, VerbContext& context) {
  if (command.length.empty() || command.mass.empty()) {
    throw UsageError("give --length and --mass-per-length, or --table");
  }
  if (!command.band.empty() && !(command.band[0] >= 0 && command.band[1] > command.band[0])) {
    throw UsageError("--band needs two rising frequencies in Hz");
  }
  ident::TensionInputs inputs;
  inputs.test = {"", description_of(command), measured_modes(command, context)};
  if (inputs.test.modes.empty() && command.files.empty()) {
    throw UsageError("give recordings, --measured or --frequencies");
  }
  for (const auto& file : command.files) {
    auto recording = load_recording(file, context, command.sample_rate_hz);
    const std::string name = recording.path.string();
    inputs.recordings.push_back({name, std::move(recording)});
  }
  inputs.channels = command.channels;
  if (!command.band.empty()) {
    inputs.band_low_hz = command.band[0];
    inputs.band_high_hz = command.band[1];
  }
  inputs.max_peaks = command.max_peaks;
  inputs.plane = plane_of(command);
  auto& options = inputs.test.options;
  options.ends = ident::cable_ends(command.ends);
  options.missed = command.missed;
  options.false_mode = command.false_mode;
  const auto campaign = ident::tension_campaign(inputs);
  if (!campaign.modes.empty()) {
    try {
      ident::check_cable(inputs.test.cable, campaign.modes);
    } catch (const std::invalid_argument& error) {
      throw UsageError(error.what());
    }
  }
  const auto& result = campaign.result.tension;
  auto findings = campaign.result.findings;
  if (!result.solved) std::erase_if(findings, [](const auto& f) { return f.code == "no_tension"; });
  context.tell(findings);
  if (!result.solved) {
    throw Refused(result.message, campaign.modes.empty() ? "no_peaks" : "no_tension");
  }
  print_tension(context.out, result);
  if (context.plots) draw_tension(*context.plots, result);
  return tension_json(campaign);
}

Json run(const TensionCommand& command, VerbContext& context) {
  if (command.table.empty()) return one_cable(command, context);
  if (!command.files.empty() || !command.measured.empty() || !command.frequencies.empty() ||
      !command.length.empty() || !command.mass.empty()) {
    throw UsageError("--table brings lengths, masses and frequencies of its own");
  }
  return table_of_cables(command, context);
}

describe::Options options_of(TensionCommand& c) {
  using describe::option;
  return {
      option("files", c.files, "Recordings of the cable's motion: peaks of their spectra")
          .type("FILE"),
      option("--channel", c.channels, "Channels to use (default: all)").type("C"),
      option("--band", c.band, "Where peaks are looked for", "Hz").count(2).type("LO HI"),
      option("--max-peaks", c.max_peaks, "Peaks a channel at most").within(1, 200),
      option("--sample-rate", c.sample_rate_hz, "Where a file gives none", "Hz").positive(),
      option("--measured", c.measured, "Table of measured frequencies, or modes as UFF 55")
          .type("F"),
      option("--column", c.column, "Column of the frequencies in the table").type("NAME"),
      option("--frequencies", c.frequencies, "Measured frequencies", "Hz").positive().type("HZ"),
      option("--frequency-std", c.frequency_std, "Standard uncertainty of --frequencies", "Hz")
          .positive(),
      option("--order", c.orders, "Which modes --frequencies are: 1 is the first of its plane")
          .within(1, 200)
          .type("N"),
      option("--plane", c.plane, "The motion that was measured").one_of({"in", "out", "any"}),
      option("--length", c.length, "Between the ends, along the chord", "m").type("V[,STD]"),
      option("--mass-per-length", c.mass, "Of the cable", "kg/m").type("V[,STD]"),
      option("--table", c.table, "Many cables, a row each (columns: ident/tension/README.md)")
          .type("CABLES.csv"),
      option("--out", c.out, "Table of the tensions of --table").writes().type("F.csv"),
      option("--mass-at", c.masses,
             "Masses or clamps on the cable: place from 0 to 1 of its length, kg (the largest "
             "relative std counts for all)")
          .type("PLACE=KG[,STD]"),
      option("--mass-of", c.mass_of, "State of the cable that the mass per length is of")
          .one_of({"installed", "unstretched"}),
      option("--EI", c.EI, "Flexural rigidity, N m2 (default: fitted)").type("V[,STD]"),
      option("--EA", c.EA, "Axial rigidity", "N").type("V[,STD]"),
      option("--inclination", c.inclination, "Of the chord, degrees: 0 horizontal, 90 a hanger")
          .within(-90, 90),
      option("--ends", c.ends, "Kinds of ends")
          .one_of({ident::kCableEndsWords.begin(), ident::kCableEndsWords.end()}),
      option("--missed", c.missed, "Probability that a mode in the band was missed")
          .within(0.001, 0.9),
      option("--false", c.false_mode, "Probability that a measured mode is none of the cable's")
          .within(0.001, 0.9)};
}

}  // namespace

Verb tension_verb() {
  Verb verb = verb_of<TensionCommand>(
      "tension", "Tension of a cable, hanger or stay from its frequencies", kExample,
      [](const TensionCommand& c, VerbContext& context) { return run(c, context); });
  verb.draws = true;
  verb.reads = true;
  return verb;
}

}  // namespace rigfit::apps
