#include "apps/cli/verbs/all.h"

#include <thread>

#include "model/scene/actual_state.h"
#include "signal/readers/recording_description.h"
#include "signal/recording/units.h"

namespace rigfit::apps {

Verbs all_verbs() {
  return {inspect_verb(), resample_verb(), bending_verb(), axial_verb(),      decay_verb(),
          frf_verb(),     modal_verb(),    modes_verb(),   respond_verb(),    update_verb(),
          tension_verb(), predict_verb(),  plan_verb(),    synthesize_verb(), export_verb(),
          bench_verb(),   new_verb(),      report_verb()};
}

void write_result(const std::string& file, const std::function<std::string()>& content,
                  const char* what, const char* key, Json& result, VerbContext& context) {
  if (file.empty()) return;
  context.write(file, content());
  context.out << what << ": " << file << '\n';
  result[key] = file;
}

void warn_of_mass(const model::Scene& scene, const std::string& file, VerbContext& context) {
  const double strain = model::undecided_mass(scene);
  if (strain == 0) return;
  context.warn(
      "mass_of",
      fmt::format("say mass_of = \"installed\" or \"unstretched\" of the cables: which one "
                  "changes the mass by {:.2g} %, frequencies by half of that",
                  100 * strain),
      file);
}

void add_column(signal::Recording& table, std::string name, const std::string& unit,
                Eigen::VectorXd samples) {
  table.channels.push_back(
      {.name = std::move(name), .unit = unit, .source_unit = unit, .samples = std::move(samples)});
}

describe::Options options_of(signal::ReadOptions& c) {
  const auto take_unit = [&c](const std::string& text) {
    if (const auto unit = signal::parse_unit(text)) c.time_unit_s = unit->factor;
  };
  return {option("--sample-rate", c.sample_rate_hz, "Of files that give none", "Hz").positive(),
          option("--format", c.format, "Format of the files, where their content misleads")
              .one_of(signal::format_names()),
          converted(
              "--decimal", [&c](const auto& text) { c.decimal = signal::sign_named(text); },
              "Decimal sign of tables")
              .one_of({"point", "comma", ".", ","})
              .type("point|comma"),
          converted(
              "--separator", [&c](const auto& text) { c.separator = signal::sign_named(text); },
              "Between columns of tables")
              .one_of({"comma", "semicolon", "tab", "blank", "space", "\\t", ",", ";", "\t", " "})
              .type("comma|semicolon|tab|blank"),
          converted("--time-unit", take_unit, "Unit of the time column")
              .one_of({"s", "ms", "us", "min"}),
          option("--variable", c.variables, "Arrays to take of .mat files")};
}

describe::Options SharedOptions::options(VerbContext& context, bool reads, bool draws) {
  context.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  describe::Options all;
  const auto add = [&](const char* heading, const describe::Options& more) {
    for (auto one : more) all.push_back(one.group(heading));
  };
  if (reads) add("Reading", options_of(context.reading));
  add("Common",
      {option("--json", json, "Write the result as JSON; '-': to standard output").writes(),
       option("--quiet", context.quiet, "Print errors only"),
       option("--verbose", context.verbose, "Print every warning, and the notes"),
       option("--threads", context.threads,
              "Threads to use (all processors); the numbers do not depend on it")
           .within(1, 1024),
       option("--seed", context.seed, "Seed of every random number").from_zero()});
  if (draws) {
    add("Common", {option("--plot", plot,
                          "Draw the result: an interactive page (.html) or a picture (.svg, .png)")
                       .writes()
                       .type("F.html|svg|png")});
  }
  return all;
}

}  // namespace rigfit::apps
