// The ten-mode truth through the whole way, hits in recordings to modes with error bars, over
// seeds: how many modes come out, the largest and rms errors of frequency and damping, and how
// often 95 % intervals hold the truth. Prints Markdown tables.
//
//   modal_truth [--seeds N] [--first SEED] [--window RATE]... [--noise LEVEL] [--high HZ]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdio>
#include <vector>

#include "signal/impact/impact_frfs.h"
#include "signal/modal/modal_identification.h"
#include "signal/modes/mac.h"
#include "tests/reference/ten_mode_truth.h"

namespace rigfit {
namespace {
using Eigen::Index;

struct Options {
  int seeds = 20;
  unsigned first = 1;
  std::vector<double> windows{0.0, 1.0};
  double noise = 0.005;
  double high_hz = 1400;
};

/// Sums over seeds of one mode.
struct Tally {
  double worst_frequency = 0, square_frequency = 0, worst_damping = 0, square_damping = 0;
  double bias_frequency = 0, bias_damping = 0;
  int frequency_covered = 0, damping_covered = 0, shape_covered = 0, shape_total = 0;
  int doubtful = 0;
  double least_mac = 1;
};

struct Study {
  std::vector<Tally> modes{10};
  int right = 0, fewer = 0, more = 0, unconverged = 0;
  double frf_s = 0, modal_s = 0;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void one_seed(const testing::TenModeTruth& truth, const Options& options, double window,
              unsigned seed, Study& study) {
  testing::ImpactRecordOptions record;
  record.seed = seed;
  record.noise = options.noise;
  const signal::Recording recording = testing::impact_recording(truth, record);
  std::vector<std::string> responses;
  for (Index j = 1; j <= truth.shapes.rows(); ++j) responses.push_back(fmt::format("a{}", j));
  signal::ImpactTestOptions impact;
  impact.hits.block_s = static_cast<double>(record.block_samples) / record.sample_rate_hz;
  impact.exponential_decay_rate_1_s = window;
  const auto begin = std::chrono::steady_clock::now();
  const signal::ImpactTest test =
      signal::analyse_impact_test({&recording, 1}, "force", responses, impact);
  const double frf_s = seconds_since(begin);
  signal::ModalOptions modal;
  modal.high_hz = options.high_hz;
  const auto middle = std::chrono::steady_clock::now();
  const signal::ModalResult result = identify_modes(test.frfs, modal);
  const double modal_s = seconds_since(middle);

  study.frf_s += frf_s;
  study.modal_s += modal_s;
  study.unconverged += result.end != signal::StepsEnd::converged;
  const auto& modes = result.model.modes;
  if (modes.size() != 10) {
    ++(modes.size() < 10 ? study.fewer : study.more);
    fmt::print("seed {}: {} modes:", seed, modes.size());
    for (const auto& mode : modes) {
      fmt::print(" {:.4g} Hz {:.3g} %{}", mode.frequency_hz.value, 100 * mode.damping_ratio.value,
                 mode.doubtful ? " (doubtful)" : "");
    }
    fmt::print("\n");
    return;
  }
  ++study.right;
  const Eigen::MatrixXcd residues = truth.residues();
  for (std::size_t r = 0; r < 10; ++r) {
    const auto i = static_cast<Index>(r);
    const signal::IdentifiedMode& mode = modes[r];
    Tally& tally = study.modes[r];
    const double df = mode.frequency_hz.value - truth.frequency_hz[i];
    const double dz = mode.damping_ratio.value - truth.damping_ratio[i];
    const double ppm = 1e6 * df / truth.frequency_hz[i];
    const double percent = 100 * dz / truth.damping_ratio[i];
    tally.worst_frequency = std::max(tally.worst_frequency, std::abs(ppm));
    tally.worst_damping = std::max(tally.worst_damping, std::abs(percent));
    tally.square_frequency += ppm * ppm;
    tally.square_damping += percent * percent;
    tally.bias_frequency += df / mode.frequency_hz.std;
    tally.bias_damping += dz / mode.damping_ratio.std;
    tally.frequency_covered += std::abs(df) < 1.96 * mode.frequency_hz.std;
    tally.damping_covered += std::abs(dz) < 1.96 * mode.damping_ratio.std;
    tally.doubtful += mode.doubtful;
    tally.least_mac = std::min(tally.least_mac, signal::mac(mode.shape, residues.col(i)));
    for (Index o = 0; o < residues.rows(); ++o) {
      const std::complex<double> d = mode.shape[o] - residues(o, i);
      tally.shape_covered += std::abs(d.real()) < 1.96 * mode.shape_std(o, 0);
      tally.shape_covered += std::abs(d.imag()) < 1.96 * mode.shape_std(o, 1);
      tally.shape_total += 2;
    }
  }
}

void print(const Study& study, const testing::TenModeTruth& truth, const Options& options,
           double window) {
  fmt::print("\n## Exponential window {} 1/s, noise {} %, {} seeds, to {} Hz\n\n", window,
             100 * options.noise, options.seeds, options.high_hz);
  fmt::print(
      "Ten modes in {} of {} seeds (fewer: {}, more: {}); not converged: {}; mean time {:.0f} "
      "ms for FRFs, {:.0f} ms for modes.\n\n",
      study.right, options.seeds, study.fewer, study.more, study.unconverged,
      1e3 * study.frf_s / options.seeds, 1e3 * study.modal_s / options.seeds);
  fmt::print(
      "| f, Hz | damping, % | worst f, ppm | rms f, ppm | worst damping, % of it | rms | f in "
      "95 % | damping in 95 % | residues in 95 % | mean error / std, f | damping | least MAC |\n");
  fmt::print("|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  const double n = std::max(1, study.right);
  double covered = 0, shapes = 0, shape_total = 0;
  int doubtful = 0;
  for (std::size_t r = 0; r < 10; ++r) {
    const Tally& t = study.modes[r];
    const auto i = static_cast<Index>(r);
    fmt::print(
        "| {:.4g} | {:.4g} | {:.2f} | {:.2f} | {:.3f} | {:.3f} | {:.1f} % | {:.1f} % | {:.1f} % | "
        "{:.2f} | {:.2f} | {:.6f} |\n",
        truth.frequency_hz[i], 100 * truth.damping_ratio[i], t.worst_frequency,
        std::sqrt(t.square_frequency / n), t.worst_damping, std::sqrt(t.square_damping / n),
        100 * t.frequency_covered / n, 100 * t.damping_covered / n,
        100.0 * t.shape_covered / std::max(1, t.shape_total), t.bias_frequency / n,
        t.bias_damping / n, t.least_mac);
    covered += t.frequency_covered + t.damping_covered;
    shapes += t.shape_covered;
    shape_total += t.shape_total;
    doubtful += t.doubtful;
  }
  fmt::print(
      "\n95 % intervals hold the truth: {:.2f} % of {:.0f} frequencies and damping ratios; "
      "{:.2f} % of {:.0f} parts of residues. Modes called doubtful: {}.\n",
      100 * covered / (20 * n), 20 * n, 100 * shapes / std::max(1.0, shape_total), shape_total,
      doubtful);
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app{"Ten-mode truth: errors and coverage of modal parameters over noise seeds"};
  app.add_option("--seeds", options.seeds)->check(CLI::Range(1, 100000))->capture_default_str();
  app.add_option("--first", options.first, "First seed")->capture_default_str();
  app.add_option("--window", options.windows, "Decay rates of the exponential window, 1/s")
      ->capture_default_str();
  app.add_option("--noise", options.noise, "Of each channel's rms")->capture_default_str();
  app.add_option("--high", options.high_hz, "End of the band, Hz")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const testing::TenModeTruth truth = testing::ten_mode_truth();
  for (const double window : options.windows) {
    Study study;
    for (int i = 0; i < options.seeds; ++i) {
      one_seed(truth, options, window, options.first + static_cast<unsigned>(i), study);
    }
    print(study, truth, options, window);
  }
  return 0;
}

}  // namespace
}  // namespace rigfit

int main(int argc, char** argv) { return rigfit::run(argc, argv); }
