// The ten-mode truth from hits in recordings to modes with error bars: do ten modes come out, and
// how often do 95 % intervals of frequency, damping and residues hold the truth?
#include "signal/impact/impact_frfs.h"
#include "signal/modal/modal_identification.h"
#include "tests/bench/study.h"
#include "tests/reference/ten_mode_truth.h"

namespace {

using namespace rigfit;

struct Case {
  std::string name;
  double window_1_s;
};

void identify(const Case& one, std::uint64_t seed, study::Table& table) {
  const auto truth = testing::ten_mode_truth();
  testing::ImpactRecordOptions record{.seed = seed};
  record.noise = 0.005;
  const signal::Recording recording = testing::impact_recording(truth, record);
  std::vector<std::string> responses;
  for (Index j = 1; j <= truth.shapes.rows(); ++j) responses.push_back(fmt::format("a{}", j));
  const auto [test, frf_s] = study::timed([&] {
    return signal::analyse_impact_test(
        {&recording, 1}, "force", responses,
        {.hits = {.block_s = static_cast<double>(record.block_samples) / record.sample_rate_hz},
         .exponential_decay_rate_1_s = one.window_1_s});
  });
  const auto [result, modal_s] =
      study::timed([&] { return identify_modes(test.frfs, {.high_hz = 1400}); });
  table.add("s for FRFs", frf_s);
  table.add("s for modes", modal_s);
  table.add("not converged", result.end != signal::StepsEnd::converged);
  const auto& modes = result.model.modes;
  table.add("ten modes", modes.size() == 10);
  table.add("fewer", modes.size() < 10);
  if (modes.size() != 10) return;
  const Eigen::MatrixXcd residues = truth.residues();
  for (Index r = 0; r < 10; ++r) {
    const signal::IdentifiedMode& mode = modes[r];
    const double df = mode.frequency_hz.value - truth.frequency_hz[r];
    const double dz = mode.damping_ratio.value - truth.damping_ratio[r];
    table.add("doubtful", mode.doubtful);
    table.add("f held, %", std::abs(df) < 1.96 * mode.frequency_hz.std);
    table.add("damping held, %", std::abs(dz) < 1.96 * mode.damping_ratio.std);
    table.add("least MAC", signal::mac(mode.shape, residues.col(r)));
    for (Index o = 0; o < residues.rows(); ++o) {
      const std::complex<double> d = mode.shape[o] - residues(o, r);
      table.add("residues held, %", std::abs(d.real()) < 1.96 * mode.shape_std(o, 0));
      table.add("residues held, %", std::abs(d.imag()) < 1.96 * mode.shape_std(o, 1));
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  using enum study::Of;
  study::run(study::arguments(argc, argv, 20),
             {"exponential window",
              {{"ten modes", sum},
               {"fewer", sum},
               {"not converged", sum},
               {"doubtful", sum},
               {"f held, %"},
               {"damping held, %"},
               {"residues held, %"},
               {"least MAC", least, "{:.6f}"},
               {"s for FRFs", mean},
               {"s for modes", mean}}},
             std::vector<Case>{{"none", 0}, {"1 1/s", 1}}, identify);
}
