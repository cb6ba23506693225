// Time of `identify_modes` beside what it finds: of ten modes (the FRFs of modal_truth), and of
// twelve of a bar under a roving hammer, 0.2 % damped, whose poles scatter between points.
#include "signal/modal/modal_identification.h"
#include "tests/bench/study.h"
#include "tests/reference/defective_frfs.h"
#include "tests/reference/ten_mode_truth.h"

namespace {

using namespace rigfit;

struct Kind {
  std::string name;
  Index points = 0;  // of a roving hammer; 0: one hit, 222 responses
  std::vector<double> sensors = {};
  double scatter = 0, noise = 1e-3;  // half-power bandwidths; over the rms FRF
};

void identify(const Kind& kind, std::uint64_t seed, study::Table& table) {
  signal::FrfSet set;
  testing::DefectiveFrfOptions bar{.damping_ratio = 2e-3, .points = kind.points};
  bar.low_hz = 20, bar.high_hz = 420, bar.spacing_hz = 0.25;
  bar.fixed = kind.sensors, bar.scatter = kind.scatter, bar.noise = kind.noise, bar.seed = seed;
  bar.frequency_hz.resize(12);
  for (int r = 0; r < 12; ++r) bar.frequency_hz[r] = 41 + 30.7 * r + 0.3 * r * (r % 3);
  Eigen::VectorXd frequency_hz = bar.frequency_hz,
                  damping_ratio = Eigen::VectorXd::Constant(12, bar.damping_ratio);
  if (kind.points > 0) {
    set = testing::defective_frfs(bar);
  } else {
    const auto truth = testing::ten_mode_truth(222);
    frequency_hz = truth.frequency_hz, damping_ratio = truth.damping_ratio;
    set = truth.frfs(Eigen::VectorXd::LinSpaced(1601, 1400.0 / 1601, 1400));
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const double std = kind.noise * set.H.norm() / std::sqrt(static_cast<double>(set.H.size()));
    for (auto& h : set.H.reshaped()) h += std * Complex(normal(random), normal(random));
  }
  const auto [result, seconds] = study::timed([&] { return signal::identify_modes(set); });
  table.add("s", seconds);
  for (const signal::IdentifiedMode& mode : result.model.modes) {
    table.add("modes", 1);
    table.add("doubtful", mode.doubtful);
    if (mode.doubtful) continue;
    const auto &f = mode.frequency_hz, &damping = mode.damping_ratio;
    Index nearest = 0;
    table.add("f held, %",
              (frequency_hz.array() - f.value).abs().minCoeff(&nearest) < 1.96 * f.std);
    table.add("damping held, %",
              std::abs(damping.value - damping_ratio[nearest]) < 1.96 * damping.std);
  }
}

}  // namespace

int main(int argc, char** argv) {
  using enum study::Of;
  const Kind kinds[] = {{"222 x 1601 lines, ten modes, noise 0.1 %"},
                        {"74 points x 3 responses, noise 0.2 %", 74, {0.37, 0.58, 0.79}, 0, 2e-3},
                        {"the same, poles scatter", 74, {0.37, 0.58, 0.79}, 0.2, 2e-3},
                        {"222 points x 1, scatter, noise 2 %", 222, {0.37}, 0.2, 0.02}};
  study::run(
      study::arguments(argc, argv, 5),
      {"FRFs",
       {{"s", median}, {"modes", sum}, {"doubtful", sum}, {"f held, %"}, {"damping held, %"}}},
      kinds, identify);
}
