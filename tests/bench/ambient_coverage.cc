// Modes from ambient motion: are they found, do their 95 % intervals hold, how near to the
// Cramer-Rao bound of an isolated mode are they? A chain of five storeys and its variations, with
// exact truth.
#include "signal/ambient/ambient_modes.h"
#include "tests/bench/study.h"
#include "tests/reference/ambient_motion.h"

namespace {

using namespace rigfit;
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
      if (k % 2000 < 100) r.channels[k / 2000 % 5].samples[k] = NAN;
  };
  add("two set-ups").two_setups = true;
  auto& pair = add("pair 0.5 %, 1 h");
  pair.structure = reference::close_pair(0.005, 6);
  pair.motion.rate_hz = 10, pair.motion.duration_s = 3600;
  pair.low_hz = 1, pair.high_hz = 3;
  return all;
}

signal::AmbientResult analysed(const Case& one, std::uint64_t seed) {
  auto motion = one.motion;
  motion.seed = seed;
  if (one.name == "gusts") motion.amplitude = gusts(seed);
  signal::AmbientOptions options{.low_hz = one.low_hz, .high_hz = one.high_hz};
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

void identify(const Case& one, std::uint64_t seed, study::Table& table) {
  const auto [result, seconds] = study::timed([&] { return analysed(one, seed); });
  table.add("s", seconds);
  std::vector<bool> taken(result.modes.size(), false);
  for (Index r = 0; r < one.structure.frequency_hz.size(); ++r) {
    const double f = one.structure.frequency_hz[r], zeta = one.structure.damping_ratio[r];
    Eigen::VectorXcd shape = one.structure.shapes.col(r);
    if (result.channels.size() == 5 && one.two_setups)
      shape = shape(std::vector<Index>{0, 4, 1, 2, 3}).eval();
    // Modes of a pair are told by their shapes.
    const int best = study::take_nearest(taken, 1.5 * zeta * f, [&](std::size_t i) {
      const auto& mode = result.modes[i].mode;
      return std::abs(mode.frequency_hz.value - f) +
             (1 - signal::mac(mode.shape, shape)) * zeta * f;
    });
    table.add("modes", 1);
    table.add("lost", best < 0);
    if (best < 0) continue;
    const auto& found = result.modes[best];
    table.add("doubtful", found.mode.doubtful);
    if (found.mode.doubtful) continue;
    const double bound = std::sqrt(one.motion.duration_s * zeta * f * 2 * std::numbers::pi *
                                   (one.two_setups ? 2 : 1));
    const double dz = found.mode.damping_ratio.value / zeta - 1;
    table.add("f held, %", study::held(found.frequency_95, f));
    table.add("damping held, %", study::held(found.damping_95, zeta));
    table.add(fmt::format("rms f {}", r + 1),
              (found.mode.frequency_hz.value - f) / (zeta * f) * bound);
    table.add(fmt::format("rms damping {}", r + 1), dz * bound);
    table.add(fmt::format("bias {}, %", r + 1), 100 * dz);
  }
  for (std::size_t i = 0; i < taken.size(); ++i) {
    table.add("sure false", !taken[i] && !result.modes[i].mode.doubtful);
  }
}

}  // namespace

int main(int argc, char** argv) {
  using enum study::Of;
  std::vector<study::Column> columns{{"modes", sum},    {"lost", sum}, {"sure false", sum},
                                     {"doubtful", sum}, {"f held, %"}, {"damping held, %"},
                                     {"s", mean}};
  for (int r = 1; r <= 5; ++r) {  // errors over the bound, of each mode
    columns.push_back({fmt::format("rms f {}", r), rms});
    columns.push_back({fmt::format("rms damping {}", r), rms});
    columns.push_back({fmt::format("bias {}, %", r), mean, "{:+.1f}"});
  }
  study::run(study::arguments(argc, argv, 10), {"motion", columns}, cases(), identify);
}
