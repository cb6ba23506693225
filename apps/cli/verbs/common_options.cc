#include "apps/cli/verbs/common_options.h"

#include "signal/readers/recording_description.h"
#include "signal/recording/units.h"

namespace rigfit::apps {

describe::Options options_of(CommonOptions& c) {
  using describe::option;
  return {option("--json", c.json, "Write the result as JSON; '-': to standard output").writes(),
          option("--quiet", c.quiet, "Print errors only"),
          option("--verbose", c.verbose, "Print every warning, and the notes"),
          option("--threads", c.threads,
                 "Threads to use (all processors); the numbers do not depend on it")
              .within(1, 1024),
          option("--seed", c.seed, "Seed of every random number").from_zero()};
}

describe::Options options_of(ReadingOptions& c) {
  using describe::option;
  return {
      option("--sample-rate", c.reading.sample_rate_hz, "Of files that give none", "Hz").positive(),
      option("--format", c.reading.format, "Format of the files, where their content misleads")
          .one_of(signal::format_names()),
      option("--decimal", c.decimal, "Decimal sign of tables")
          .one_of({"point", "comma", ".", ","})
          .type("point|comma"),
      option("--separator", c.separator, "Between columns of tables")
          .one_of({"comma", "semicolon", "tab", "blank", "space", "\\t", ",", ";", "\t", " "})
          .type("comma|semicolon|tab|blank"),
      option("--time-unit", c.time_unit, "Unit of the time column")
          .one_of({"s", "ms", "us", "min"}),
      option("--variable", c.reading.variables, "Arrays to take of .mat files"),
      option("--sheet", c.reading.sheet, "Sheet of .xlsx files (the first), or its number as #2")};
}

signal::ReadOptions read_options(const ReadingOptions& given) {
  signal::ReadOptions options = given.reading;
  if (!given.decimal.empty()) options.decimal = signal::sign_named(given.decimal);
  if (!given.separator.empty()) options.separator = signal::sign_named(given.separator);
  if (const auto unit = signal::parse_unit(given.time_unit); !given.time_unit.empty() && unit) {
    options.time_unit_s = unit->factor;
  }
  return options;
}

describe::Options SharedOptions::options(bool reads, bool draws) {
  describe::Options all;
  const auto add = [&](const char* heading, const describe::Options& more) {
    for (auto one : more) all.push_back(one.group(heading));
  };
  if (reads) add("Reading", options_of(reading));
  add("Common", options_of(common));
  if (draws) add("Common", options_of(plots));
  return all;
}

void SharedOptions::apply(VerbContext& context) const {
  context.quiet = common.quiet;
  context.verbose = common.verbose;
  context.threads = common.threads;
  context.seed = common.seed;
  context.reading = read_options(reading);
}

}  // namespace rigfit::apps
