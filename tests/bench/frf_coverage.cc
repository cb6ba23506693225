// A beam's stiffness, tip mass and damping from FRFs, segments "auto": do the 95 % intervals hold?
// From white noise of known size to hits that scatter in place under noise that a force window
// leaves, one step a row; then a sample rate that is off.
#include <random>
#include <string>
#include <vector>

#include "tests/bench/study.h"
#include "tests/ident/update/hammered_beam.h"

namespace {

namespace study = rigfit::study;
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

UpdateResult fit_recorded_beam(const std::vector<MeasuredFrf>& frfs, double rate) {
  if (rate == 0) return testing::fit_hammered_beam(frfs, 0);
  UpdateState state{"beam",
                    testing::hammered_beam(1.02 * testing::kBeamEI, 1.1 * testing::kTipMass, 0),
                    {},
                    frfs};
  state.clock_relative_std = rate;
  return update_model({state}, {{"beam.EI_z"}, {"tip.mass"}, {"beam.damping_ratio"}},
                      {.starts = 1});
}

struct Kind {
  std::string name;
  testing::HammerTestNoise noise;
  double rate = 0;  // relative standard uncertainty of the sample rate
};

void fit(const Kind& kind, std::uint64_t seed, study::Table& table) {
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(141, 30, 100);
  const auto frfs = recorded_frfs(lines, kind.noise, kind.rate, seed);
  const auto [result, seconds] = study::timed([&] { return fit_recorded_beam(frfs, kind.rate); });
  const auto& EI = result.parameters[0];
  table.add("EI held, %", study::held(EI, testing::kBeamEI));
  table.add("mass held, %", study::held(result.parameters[1], testing::kTipMass));
  table.add("damping held, %", study::held(result.parameters[2], testing::kBeamDamping));
  table.add("error / std, mean", (EI.value - testing::kBeamEI) / EI.std);
  table.add("error / std, rms", (EI.value - testing::kBeamEI) / EI.std);
  table.add("std of EI, %", 100 * EI.std / testing::kBeamEI);
  table.add("chi2 / dof", result.fit.chi2 / result.fit.degrees_of_freedom);
  table.add("ruled out", result.fit.ruled_out());
  table.add("s a fit", seconds);
}

}  // namespace

int main(int argc, char** argv) {
  using enum study::Of;
  const Kind kinds[] = {
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
  study::run(study::arguments(argc, argv, 40, 0),
             {"noise",
              {{"EI held, %"},
               {"mass held, %"},
               {"damping held, %"},
               {"error / std, mean", mean, "{:+.2f}"},
               {"error / std, rms", rms},
               {"std of EI, %", mean},
               {"chi2 / dof", mean},
               {"ruled out", sum},
               {"s a fit", mean}}},
             kinds, fit);
}
