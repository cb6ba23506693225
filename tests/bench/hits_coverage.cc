// Hits that are not as one wishes, from time-domain simulation to modes, over seeds: how often 95 %
// intervals of frequency and damping hold the truth, how many modes are called doubtful, invented
// or lost.
#include "signal/impact/impact_frfs.h"
#include "signal/modal/modal_identification.h"
#include "tests/bench/study.h"
#include "tests/reference/struck_structure.h"

namespace rigfit {
namespace {

struct Case {
  std::string name;
  Index responses = 1;
  testing::StrikeOptions strike;
  signal::ImpactTestOptions impact;
};

void identify(const Case& test, std::uint64_t seed, study::Table& table) {
  testing::StrikeOptions strike = test.strike;
  strike.seed = seed;
  const testing::StruckStructure structure(test.responses);
  const auto recordings = struck_recordings(structure, strike);
  std::vector<std::string> names;
  for (Index j = 1; j <= test.responses; ++j) names.push_back(fmt::format("a{}", j));
  signal::ImpactTestOptions impact = test.impact;
  impact.hits.band_hz = {3, 70};
  const auto [result, seconds] = study::timed([&] {
    const auto measured = signal::analyse_impact_test(recordings, "force", names, impact);
    return measured.frfs.averages > 0 ? identify_modes(measured.frfs, {.low_hz = 3, .high_hz = 70})
                                      : signal::ModalResult{};
  });
  table.add("s", seconds);
  table.add("modes", static_cast<double>(structure.frequency_hz.size()));
  for (const auto& mode : result.model.modes) {
    Index nearest = 0;
    (structure.frequency_hz.array() - mode.frequency_hz.value).abs().minCoeff(&nearest);
    const double f = structure.frequency_hz[nearest], zeta = structure.damping_ratio[nearest];
    if (std::abs(mode.frequency_hz.value - f) > 3 * zeta * f) {
      table.add("invented sure modes", !mode.doubtful);
      continue;
    }
    table.add("sure", !mode.doubtful);
    table.add("doubtful", mode.doubtful);
    if (mode.doubtful) continue;
    const double df = (mode.frequency_hz.value - f) / mode.frequency_hz.std;
    const double dz = (mode.damping_ratio.value - zeta) / mode.damping_ratio.std;
    table.add("f held, %", std::abs(df) < 1.96);
    table.add("damping held, %", std::abs(dz) < 1.96);
    table.add("f: error / std, rms", df);
    table.add("damping: error / std, rms", dz);
  }
}

std::vector<Case> cases() {
  std::vector<Case> list;
  const auto add = [&](const std::string& name, const testing::StrikeOptions& strike,
                       std::optional<double> window = {}) {
    for (const Index responses : {Index{1}, Index{6}}) {
      Case one{fmt::format("{}; {} responses", name, responses), responses, strike, {}};
      one.impact.force_window_s = window;
      list.push_back(one);
    }
  };
  testing::StrikeOptions aside;
  aside.off_axis = 0.13, aside.off_place = 0.005;
  add("plain", {});
  add("force noise 2 %, window 0.1 s", {.force_noise = 0.02}, 0.1);
  add("force noise 2 %", {.force_noise = 0.02});
  add("frequency scatters by 0.1 % between hits", {.frequency_scatter = 1e-3});
  add("10-bit converter", {.converter_bits = 10});
  add("hammer 7.5 degrees off axis, 0.5 % off place", aside);
  add("two hits", {.hits = 2});
  return list;
}

}  // namespace
}  // namespace rigfit

int main(int argc, char** argv) {
  using namespace rigfit;
  using enum study::Of;
  study::run(study::arguments(argc, argv, 20),
             {"hits",
              {{"modes", sum},
               {"sure", sum},
               {"doubtful", sum},
               {"f held, %"},
               {"damping held, %"},
               {"f: error / std, rms", rms},
               {"damping: error / std, rms", rms},
               {"invented sure modes", sum},
               {"s", mean}}},
             cases(), identify);
}
