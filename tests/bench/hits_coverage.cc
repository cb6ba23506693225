// Hits that are not as one wishes, from time-domain simulation to modes, over seeds: how often 95 %
// intervals of frequency and damping hold the truth, how many modes are called doubtful, invented
// or lost. Prints a Markdown table.
//
//   hits_coverage [--seeds N] [--first SEED] [--only WORD]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "signal/impact/impact_frfs.h"
#include "signal/modal/modal_identification.h"
#include "tests/reference/struck_structure.h"

namespace rigfit {
namespace {
using Eigen::Index;

struct Case {
  std::string name;
  Index responses = 1;
  testing::StrikeOptions strike;
  signal::ImpactTestOptions impact;
};

struct Tally {
  int truths = 0, given = 0, doubtful = 0, frequency = 0, damping = 0, invented = 0, refused = 0;
  double frequency_square = 0, damping_square = 0;
};

void one_seed(const Case& test, std::uint64_t seed, Tally& tally) {
  testing::StrikeOptions strike = test.strike;
  strike.seed = seed;
  const testing::StruckStructure structure(test.responses);
  const auto recordings = struck_recordings(structure, strike);
  std::vector<std::string> names;
  for (Index j = 1; j <= test.responses; ++j) names.push_back(fmt::format("a{}", j));
  signal::ImpactTestOptions impact = test.impact;
  impact.hits.band_hz = {3, 70};
  const auto measured = signal::analyse_impact_test(recordings, "force", names, impact);
  tally.truths += static_cast<int>(structure.frequency_hz.size());
  if (measured.frfs.averages == 0) {
    ++tally.refused;
    return;
  }
  signal::ModalOptions modal;
  modal.low_hz = 3, modal.high_hz = 70;
  const auto result = signal::identify_modes(measured.frfs, modal);
  for (const auto& mode : result.model.modes) {
    Index nearest = 0;
    (structure.frequency_hz.array() - mode.frequency_hz.value).abs().minCoeff(&nearest);
    const double f = structure.frequency_hz[nearest], zeta = structure.damping_ratio[nearest];
    if (std::abs(mode.frequency_hz.value - f) > 3 * zeta * f) {
      tally.invented += !mode.doubtful;
      continue;
    }
    if (mode.doubtful) {
      ++tally.doubtful;
      continue;
    }
    ++tally.given;
    const double df = (mode.frequency_hz.value - f) / mode.frequency_hz.std;
    const double dz = (mode.damping_ratio.value - zeta) / mode.damping_ratio.std;
    tally.frequency += std::abs(df) < 1.96;
    tally.damping += std::abs(dz) < 1.96;
    tally.frequency_square += df * df;
    tally.damping_square += dz * dz;
  }
}

std::vector<Case> cases() {
  std::vector<Case> list;
  const auto add = [&](const std::string& name, const testing::StrikeOptions& strike,
                       std::optional<double> window = {}) {
    for (const Index responses : {Index{1}, Index{6}}) {
      Case one{name, responses, strike, {}};
      one.impact.force_window_s = window;
      list.push_back(one);
    }
  };
  testing::StrikeOptions plain, noisy, changing, coarse, aside, two;
  add("plain", plain);
  noisy.force_noise = 0.02;
  add("force noise 2 %, window 0.1 s", noisy, 0.1);
  add("force noise 2 %, by noise", noisy);
  changing.frequency_scatter = 1e-3;
  add("frequency scatters by 0.1 % between hits", changing);
  coarse.converter_bits = 10;
  add("10-bit converter", coarse);
  aside.off_axis = 0.13, aside.off_place = 0.005;
  add("hammer 7.5 degrees off axis, 0.5 % off place", aside);
  two.hits = 2;
  add("two hits", two);
  return list;
}

int run(int argc, char** argv) {
  int seeds = 20;
  unsigned first = 1;
  std::string only;
  CLI::App app{"Coverage of modes from hits with defects, over noise seeds"};
  app.add_option("--seeds", seeds)->check(CLI::Range(1, 100000))->capture_default_str();
  app.add_option("--first", first, "First seed")->capture_default_str();
  app.add_option("--only", only, "Cases whose name contains this");
  CLI11_PARSE(app, argc, argv);
  fmt::print(
      "| hits | responses | modes | sure | doubtful | f in 95 % | damping in 95 % | rms f error / "
      "std | rms damping error / std | invented sure modes | s a set "
      "|\n|---|---|---|---|---|---|---"
      "|---|---|---|---|\n");
  for (const Case& test : cases()) {
    if (test.name.find(only) == std::string::npos) continue;
    const auto begin = std::chrono::steady_clock::now();
    Tally tally;
    for (int i = 0; i < seeds; ++i) one_seed(test, first + static_cast<unsigned>(i), tally);
    const double n = std::max(1, tally.given);
    fmt::print(
        "| {} | {} | {} | {} | {} | {:.1f} % | {:.1f} % | {:.2f} | {:.2f} | {} | {:.2f} |\n",
        test.name, test.responses, tally.truths, tally.given, tally.doubtful,
        100 * tally.frequency / n, 100 * tally.damping / n, std::sqrt(tally.frequency_square / n),
        std::sqrt(tally.damping_square / n), tally.invented,
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() / seeds);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace rigfit

int main(int argc, char** argv) { return rigfit::run(argc, argv); }
