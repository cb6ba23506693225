// Runs every hard case and prints one Markdown table; exit code 1 when one of them failed.
//
//   hard_cases [--quick] [--times] [AREA...]
#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "tests/bench/hard_cases/hard_case.h"

namespace {

using namespace rigfit::hard_cases;

Outcome run(const HardCase& hard_case, bool quick) {
  try {
    return hard_case.run(quick);
  } catch (const std::exception& error) {
    return {Verdict::failed, std::string("threw: ") + error.what(), ""};
  }
}

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::held:
      return "held";
    case Verdict::refused:
      return "refused";
    case Verdict::failed:
      break;
  }
  return "FAILED";
}

}  // namespace

int main(int argc, char** argv) {
  FLAGS_minloglevel = google::FATAL;  // Ceres' own messages of fits that end without a model
  bool quick = false, times = false;
  std::vector<std::string> areas;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--quick") {
      quick = true;
    } else if (word == "--times") {
      times = true;
    } else if (!word.empty() && word[0] != '-') {
      areas.push_back(word);
    } else {
      fmt::print(stderr, "usage: hard_cases [--quick] [--times] [AREA...]\n");
      return 2;
    }
  }
  std::vector<HardCase> cases;
  for (const auto& part : {bending_cases(), record_cases(), cable_cases(), beam_cases(),
                           mode_cases(), motion_cases(), fit_cases(), decay_cases(), hit_cases()})
    cases.insert(cases.end(), part.begin(), part.end());

  int count[3] = {0, 0, 0};
  fmt::print("| area | case | must | found | allowed | verdict |{}\n|---|---|---|---|---|---|{}\n",
             times ? " s |" : "", times ? "---|" : "");
  for (const HardCase& hard_case : cases) {
    if (!areas.empty() && std::find(areas.begin(), areas.end(), hard_case.area) == areas.end()) {
      continue;
    }
    const auto start = std::chrono::steady_clock::now();
    const Outcome outcome = run(hard_case, quick);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    ++count[static_cast<int>(outcome.verdict)];
    fmt::print("| {} | {} | {} | {} | {} | {} |", hard_case.area, hard_case.name, hard_case.must,
               outcome.found, outcome.allowed, name_of(outcome.verdict));
    if (times) fmt::print(" {:.2f} |", taken.count());
    fmt::print("\n");
    std::fflush(stdout);
  }
  fmt::print("\n{} held, {} refused for the right reason, {} failed\n", count[0], count[1],
             count[2]);
  if (count[0] + count[1] + count[2] == 0) {
    fmt::print(stderr, "no such area\n");
    return 2;
  }
  return count[2] == 0 ? 0 : 1;
}
