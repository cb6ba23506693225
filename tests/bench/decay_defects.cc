// Free decays with what real records have beside them: further hits, ambient excitation, mains
// hum, close modes, a converter's steps, heavy damping, loggers that stopped, friction, a slow
// motion outside of the band. The records are integrated in time, oscillator by oscillator, by the
// exact transition matrix (friction: Runge and Kutta's method), independently of the estimator's
// model. Prints a Markdown table: of the records that are answered without a warning, the share
// whose 95 % intervals hold the truth, and how many show more modes than there are; records refused
// and records with a warning, by code.
// Arguments: records a row (100), and a part of the rows' names.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/reference/decay_records.h"

int main(int argc, char** argv) {
  const int records = argc > 1 ? std::max(2, std::atoi(argv[1])) : 100;
  const std::string only = argc > 2 ? argv[2] : "";
  std::printf(
      "%d records a row\n\n| record | f covered %% | damping covered %% | without warning %% | "
      "refused "
      "| warnings | too many modes | median ms |\n|---|---|---|---|---|---|---|---|\n",
      records);
  for (const auto& kind : rigfit::decay_records::kinds()) {
    if (kind.name.find(only) == std::string::npos) continue;
    const auto tally = rigfit::decay_records::study(kind, records);
    std::printf("%s\n", tally.row(kind.name).c_str());
    std::fflush(stdout);
  }
  return 0;
}
