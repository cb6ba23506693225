// A beam's stiffness, tip mass and damping from FRFs: do the 95 % intervals hold, whatever segments
// the scene gives? From white noise of known size to hits that scatter in place under noise that a
// force window leaves, one step a row; then a sample rate that is off. Prints a table; PART picks
// rows by name; SEGMENTS those of the fitted scene, 0: "auto".   frf_coverage [SEEDS] [FIRST SEED]
// [PART] [SEGMENTS]
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <ctime>
#include <random>
#include <string>
#include <vector>

#include "tests/ident/update/hammered_beam.h"

namespace {

using namespace rigfit::ident;

// A test whose lines are off by `rate` times a normal number, and its fit, told of that.
std::vector<MeasuredFrf> recorded_frfs(const Eigen::VectorXd& lines,
                                       const testing::HammerTestNoise& noise, double rate,
                                       std::uint64_t seed) {
  std::mt19937_64 random(seed + 1'000'003);
  std::normal_distribution<double> normal;
  const double off = rate * normal(random);
  auto frfs = testing::hammered_frfs(lines * (1 + off), noise, seed);
  for (auto& frf : frfs) frf.frequency_hz = lines;
  return frfs;
}

UpdateResult fit_recorded_beam(const std::vector<MeasuredFrf>& frfs, int segments, double rate) {
  if (rate == 0) return testing::fit_hammered_beam(frfs, segments);
  UpdateOptions options;
  options.starts = 1;
  const auto scene =
      testing::hammered_beam(1.02 * testing::kBeamEI, 1.1 * testing::kTipMass, segments);
  UpdateState state{"beam", scene, {}, frfs};
  state.clock_relative_std = rate;
  return update_model({state}, {{"beam.EI_z"}, {"tip.mass"}, {"beam.damping_ratio"}}, options);
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 40;
  const int first = argc > 2 ? std::atoi(argv[2]) : 0;
  const std::string part = argc > 3 ? argv[3] : "";
  const std::vector<int> all_segments =
      argc > 4 ? std::vector<int>{std::atoi(argv[4])} : std::vector<int>{20, 60, 0};
  struct Row {
    std::string name;
    testing::HammerTestNoise noise;
    double rate = 0;  // relative standard uncertainty of the sample rate
  };
  const Row rows[] = {
      {"response 3 %, known", {.place_m = 0, .force = 0, .response = 0.03, .known_std = true}},
      {"response 3 %, error bars of 4 hits", {.place_m = 0, .force = 0, .response = 0.03}},
      {"the same, exponential window of 1.5 1/s",
       {.place_m = 0, .force = 0, .response = 0.03, .decay_rate_1_s = 1.5}},
      {"force 1.4 % alone", {.place_m = 0, .response = 1e-3}},
      {"place 3 mm alone", {.force = 0, .response = 1e-3}},
      {"place 3 mm, force 1.4 %, response 1 %", {}},
      {"response 0.2 %, sample rate 3e-4",
       {.place_m = 0, .force = 0, .response = 0.002, .known_std = true},
       3e-4},
  };
  const double truth[] = {testing::kBeamEI, testing::kTipMass, testing::kBeamDamping};
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(141, 30, 100);
  fmt::print(
      "| noise | segments | EI | mass | damping | bias of EI / std | error / std, rms | std of EI "
      "| chi2 / dof | ruled out | s a fit |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& row : rows) {
    if (row.name.find(part) == std::string::npos) continue;
    std::vector<std::vector<MeasuredFrf>> tests;  // by seed; all rows of segments see the same
    tests.reserve(static_cast<std::size_t>(seeds));
    for (int seed = first; seed < first + seeds; ++seed) {
      tests.push_back(recorded_frfs(lines, row.noise, row.rate, static_cast<std::uint64_t>(seed)));
    }
    for (const int segments : all_segments) {
      int held[3] = {0, 0, 0}, ruled_out = 0;
      double z = 0, bias = 0, std = 0, reduced = 0, seconds = 0;
      for (const auto& frfs : tests) {
        const std::clock_t begin = std::clock();
        const auto result = fit_recorded_beam(frfs, segments, row.rate);
        seconds += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
        for (std::size_t p = 0; p < 3; ++p) {
          const auto& one = result.parameters[p];
          held[p] += one.low <= truth[p] && truth[p] <= one.high;
        }
        const auto& EI = result.parameters[0];
        z += std::pow((EI.value - truth[0]) / EI.std, 2);
        bias += (EI.value - truth[0]) / EI.std;
        std += EI.std;
        reduced += result.fit.chi2 / result.fit.degrees_of_freedom;
        ruled_out += result.fit.ruled_out();
      }
      const double n = seeds;
      fmt::print(
          "| {} | {} | {:.0f} % | {:.0f} % | {:.0f} % | {:+.2f} | {:.2f} | {:.3f} % | {:.2f} | {} "
          "| {:.2f} |\n",
          row.name, segments > 0 ? std::to_string(segments) : "auto", 100 * held[0] / n,
          100 * held[1] / n, 100 * held[2] / n, bias / n, std::sqrt(z / n),
          100 * std / n / truth[0], reduced / n, ruled_out, seconds / n);
      std::fflush(stdout);
    }
  }
}
