// Modes from ambient motion: are they found, do their 95 % intervals hold, how near to the
// Cramer-Rao bound of an isolated mode are they? A chain of five storeys and its variations, with
// exact truth. Prints a table.
//   ambient_coverage [SEEDS] [FIRST SEED] [PART OF A NAME]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "signal/ambient/ambient_modes.h"
#include "signal/modes/mac.h"
#include "tests/reference/ambient_motion.h"

namespace {

using namespace rigfit;
using Eigen::Index;
using signal::Recording;

struct Case {
  std::string name;
  reference::AmbientStructure structure;
  reference::AmbientMotion motion;
  double low_hz = 0.3, high_hz = 8;
  std::function<void(Recording&)> alter = {};
  bool two_setups = false;
};

/// Gusts of a minute, their amplitude log-normal.
std::function<double(double)> gusts(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, 0.8);
  std::vector<double> size(200);
  for (double& one : size) one = std::exp(normal(random));
  return [size](double t) { return size[static_cast<std::size_t>(t / 60) % size.size()]; };
}

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto add = [&](std::string name, double damping = 0.02) -> Case& {
    all.push_back({std::move(name), reference::five_storeys(damping), {}});
    return all.back();
  };
  add("chain, 20 min");
  add("chain, 2 h, 5 %", 0.05).motion.duration_s = 7200;
  add("chain, noise 30 %").motion.noise = 0.3;
  add("tone of 0.3 std at 2.61 Hz").alter = [](Recording& r) {
    for (auto& c : r.channels) {
      const double size = 0.3 * std::sqrt(2 * c.samples.squaredNorm() / double(c.samples.size()));
      for (Index k = 0; k < c.samples.size(); ++k)
        c.samples[k] += size * std::sin(2 * std::numbers::pi * 2.61 * double(k) / r.sample_rate_hz);
    }
  };
  add("gusts").motion.amplitude = gusts(1);
  add("a vehicle of 10 s a minute").motion.amplitude = [](double t) {
    return 0.2 + 2 * std::exp(-std::pow((std::fmod(t, 60) - 30) / 5, 2));
  };
  // What filters all forces filters all channels.
  add("forces coloured, first order").alter = [](Recording& r) {
    const double stays = std::exp(-2 * std::numbers::pi / r.sample_rate_hz);
    for (auto& c : r.channels)
      for (Index k = 1; k < c.samples.size(); ++k) c.samples[k] += stays * c.samples[k - 1];
  };
  auto& correlated = add("forces correlated 0.7");
  correlated.structure.forces.setConstant(0.7);
  correlated.structure.forces.diagonal().setOnes();
  add("gaps, 5 % missing").alter = [](Recording& r) {
    for (Index k = 0; k < r.samples(); ++k)
      if (k % 2000 < 100) r.channels[static_cast<std::size_t>(k / 2000 % 5)].samples[k] = NAN;
  };
  add("two set-ups").two_setups = true;
  auto& pair = add("pair 0.5 %, 1 h");
  pair.structure = reference::close_pair(0.005, 6);
  pair.motion.rate_hz = 10, pair.motion.duration_s = 3600;
  pair.low_hz = 1, pair.high_hz = 3;
  return all;
}

struct ModeCount {
  int found = 0, f_held = 0, zeta_held = 0;
  double f2 = 0, zeta2 = 0, zeta = 0;
};

signal::AmbientResult analysed(const Case& one, std::uint64_t seed) {
  auto motion = one.motion;
  motion.seed = seed;
  if (one.name == "gusts") motion.amplitude = gusts(seed);
  signal::AmbientOptions options;
  options.low_hz = one.low_hz, options.high_hz = one.high_hz;
  Recording recording = reference::recorded(one.structure, motion);
  if (one.alter) one.alter(recording);
  if (!one.two_setups) return signal::ambient_modes(recording, options);
  motion.seed += 100000;
  Recording second = reference::recorded(one.structure, motion);
  for (auto& c : second.channels) c.samples *= 1.6;
  std::vector<signal::AmbientResult> setups;
  options.channels = {"c1", "c5", "c2"};
  setups.push_back(signal::ambient_modes(recording, options));
  options.channels = {"c1", "c5", "c3", "c4"};
  setups.push_back(signal::ambient_modes(second, options));
  return signal::merge_setups(setups);
}

void run(const Case& one, std::uint64_t first, int seeds) {
  const Index n = one.structure.frequency_hz.size();
  std::vector<ModeCount> modes(static_cast<std::size_t>(n));
  int lost = 0, wrong = 0, doubtful = 0;
  const std::clock_t start = std::clock();
  for (int k = 0; k < seeds; ++k) {
    const auto result = analysed(one, first + static_cast<std::uint64_t>(k));
    std::vector<bool> used(result.modes.size(), false);
    for (Index r = 0; r < n; ++r) {
      const double f = one.structure.frequency_hz[r], zeta = one.structure.damping_ratio[r];
      std::size_t best = result.modes.size();
      double nearest = 1.5 * zeta * f;
      for (std::size_t i = 0; i < result.modes.size(); ++i) {
        // Modes of a pair are told by their shapes.
        Eigen::VectorXcd truth = one.structure.shapes.col(r);
        if (result.channels.size() == 5 && one.two_setups)
          truth = truth(std::vector<Index>{0, 4, 1, 2, 3}).eval();
        const double unlike = 1 - signal::mac(result.modes[i].mode.shape, truth);
        const double apart = std::abs(result.modes[i].mode.frequency_hz.value - f);
        if (used[i] || apart > 1.5 * zeta * f || apart + unlike * zeta * f > nearest) continue;
        nearest = apart + unlike * zeta * f, best = i;
      }
      if (best == result.modes.size()) {
        ++lost;
        continue;
      }
      used[best] = true;
      const auto& mode = result.modes[best];
      if (mode.mode.doubtful) {
        ++doubtful;
        continue;
      }
      auto& count = modes[static_cast<std::size_t>(r)];
      const double bound = std::sqrt(one.motion.duration_s * zeta * f * 2 * std::numbers::pi *
                                     (one.two_setups ? 2 : 1));
      const double df = (mode.mode.frequency_hz.value - f) / (zeta * f),
                   dz = mode.mode.damping_ratio.value / zeta - 1;
      ++count.found;
      count.f_held += mode.frequency_95.low < f && f < mode.frequency_95.high;
      count.zeta_held += mode.damping_95.low < zeta && zeta < mode.damping_95.high;
      count.f2 += df * df * bound * bound, count.zeta2 += dz * dz * bound * bound;
      count.zeta += dz;
    }
    for (std::size_t i = 0; i < used.size(); ++i) {
      wrong += !used[i] && !result.modes[i].mode.doubtful;
    }
  }
  const double cpu = double(std::clock() - start) / CLOCKS_PER_SEC / seeds;
  std::string rms_f, rms_zeta, bias;
  int found = 0, f_held = 0, zeta_held = 0;
  for (const auto& m : modes) {
    found += m.found, f_held += m.f_held, zeta_held += m.zeta_held;
    rms_f += fmt::format(" {:.2f}", std::sqrt(m.f2 / m.found));
    rms_zeta += fmt::format(" {:.2f}", std::sqrt(m.zeta2 / m.found));
    bias += fmt::format(" {:+.1f}", 100 * m.zeta / m.found);
  }
  fmt::print(
      "{:<28} lost {} false {} doubtful {} of {}; held f {:.1f} % zeta {:.1f} %; rms f{} zeta{}; "
      "bias %{}; {:.2f} s\n",
      one.name, lost, wrong, doubtful, seeds * n, 100.0 * f_held / found, 100.0 * zeta_held / found,
      rms_f, rms_zeta, bias, cpu);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 10;
  const auto first = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 1);
  for (const Case& one : cases()) {
    if (argc > 3 && one.name.find(argv[3]) == std::string::npos) continue;
    run(one, first, seeds);
  }
}
