#include "apps/cli/verbs/common_options.h"

#include "signal/readers/recording_description.h"
#include "signal/recording/units.h"

namespace rigfit::apps {

describe::Options options_of(CommonOptions& c) {
  using describe::option;
  return {option("--json", c.json, "Write the result as JSON to F; '-' is standard output")
              .writes()
              .type("F")
              .group("Common"),
          option("--quiet", c.quiet, "Print errors only").group("Common"),
          option("--verbose", c.verbose, "Print every warning, and the notes").group("Common"),
          option("--threads", c.threads,
                 "Threads to use (all processors); the numbers do not depend on it")
              .within(1, 1024)
              .group("Common"),
          option("--seed", c.seed, "Seed of every random number").from_zero().group("Common")};
}

describe::Options options_of(ReadingOptions& c) {
  using describe::option;
  return {option("--sample-rate", c.sample_rate_hz, "Of files that give none", "Hz")
              .positive()
              .group("Reading"),
          option("--format", c.format, "Format of the files, where their content misleads")
              .one_of(signal::format_names())
              .group("Reading"),
          option("--decimal", c.decimal, "Decimal sign of tables")
              .one_of({"point", "comma", ".", ","})
              .type("point|comma")
              .group("Reading"),
          option("--separator", c.separator, "Between columns of tables")
              .one_of({"comma", "semicolon", "tab", "blank", "space", "\\t", ",", ";", "\t", " "})
              .type("comma|semicolon|tab|blank")
              .group("Reading"),
          option("--time-unit", c.time_unit, "Unit of the time column")
              .one_of({"s", "ms", "us", "min"})
              .group("Reading"),
          option("--variable", c.variables, "Arrays to take of .mat files")
              .type("NAME")
              .group("Reading"),
          option("--sheet", c.sheet, "Sheet of .xlsx files (the first), or its number as #2")
              .type("NAME")
              .group("Reading")};
}

signal::ReadOptions read_options(const ReadingOptions& given) {
  signal::ReadOptions options;
  options.sample_rate_hz = given.sample_rate_hz;
  options.format = given.format;
  options.variables = given.variables;
  options.sheet = given.sheet;
  if (!given.decimal.empty()) options.decimal = signal::sign_named(given.decimal);
  if (!given.separator.empty()) options.separator = signal::sign_named(given.separator);
  if (const auto unit = signal::parse_unit(given.time_unit); !given.time_unit.empty() && unit) {
    options.time_unit_s = unit->factor;
  }
  return options;
}

describe::Options SharedOptions::options(bool reads, bool draws) {
  describe::Options all;
  const auto add = [&](const describe::Options& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  if (reads) add(options_of(reading));
  add(options_of(common));
  if (draws) add(options_of(plots));
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
