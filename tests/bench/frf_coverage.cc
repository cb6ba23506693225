// A beam's stiffness, tip mass and damping from FRFs, segments "auto": do the 95 % intervals hold?
// From white noise of known size to hits that scatter in place under noise that a force window
// leaves, one step a row.
#include "tests/bench/study.h"
#include "tests/ident/update/hammered_beam.h"

namespace {

namespace study = rigfit::study;
using namespace rigfit::ident;

struct Kind {
  std::string name;
  testing::HammerTestNoise noise;
};

void fit(const Kind& kind, std::uint64_t seed, study::Table& table) {
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(141, 30, 100);
  const auto frfs = testing::hammered_frfs(lines, kind.noise, seed);
  const auto [result, seconds] = study::timed([&] { return testing::fit_hammered_beam(frfs, 0); });
  const auto& EI = result.parameters[0];
  table.add("EI held, %", study::held(EI, testing::kBeamEI));
  table.add("mass held, %", study::held(result.parameters[1], testing::kTipMass));
  table.add("damping held, %", study::held(result.parameters[2], testing::kBeamDamping));
  table.add("error / std, rms", (EI.value - testing::kBeamEI) / EI.std);
  table.add("std of EI, %", 100 * EI.std / testing::kBeamEI);
  table.add("s a fit", seconds);
}

}  // namespace

int main(int argc, char** argv) {
  using enum study::Of;
  const Kind kinds[] = {
      {"response 3 %, known", {.place_m = 0, .force = 0, .response = 0.03, .known_std = true}},
      {"response 3 %, exponential window of 1.5 1/s",
       {.place_m = 0, .force = 0, .response = 0.03, .decay_rate_1_s = 1.5}},
      {"force 1.4 % alone", {.place_m = 0, .response = 1e-3}},
      {"place 3 mm, force 1.4 %, response 1 %", {}},
  };
  study::run(study::arguments(argc, argv, 40, 0),
             {"noise",
              {{"EI held, %"},
               {"mass held, %"},
               {"damping held, %"},
               {"error / std, rms", rms},
               {"std of EI, %", mean},
               {"s a fit", mean}}},
             kinds, fit);
}
