// Free decays with what real records have beside them: mains hum, a converter's steps, jitter of
// the sampling clock. Intervals are those of the records that are answered without a warning.
#include "signal/decay/decay.h"
#include "tests/bench/study.h"
#include "tests/signal/decays.h"

namespace {

using namespace rigfit;
using rigfit::testing::add_decay, rigfit::testing::add_noise;

struct Record {
  Eigen::VectorXd samples;
  double rate_hz = 0;
  double frequency_hz = 0, damping_ratio = 0;
};

using Random = std::mt19937_64;

struct Kind {
  std::string name;
  std::function<Record(Random&)> make;
};

double uniform(Random& draw, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(draw);
}

Record plain(double f, double zeta, double rate, double seconds) {
  Record record;
  record.rate_hz = rate, record.frequency_hz = f, record.damping_ratio = zeta;
  record.samples = Eigen::VectorXd::Zero(static_cast<Index>(std::lround(seconds * rate)));
  return record;
}

Record with_hum(double zeta, double seconds, double quiet_s, Random& draw) {
  const double f = 50 + (uniform(draw, 0, 1) < 0.5 ? -1 : 1) * uniform(draw, 0.2, 1.0);
  Record record = plain(f, zeta, 1000, quiet_s + seconds);
  const double phase = uniform(draw, 0, 2 * std::numbers::pi);
  const auto first = static_cast<Index>(1000 * quiet_s);
  add_decay(record.samples, {f, zeta}, 1000, quiet_s > 0 ? -std::numbers::pi / 2 : phase, first);
  add_decay(record.samples, {50, 0, 0.05}, 1000, uniform(draw, 0, 2 * std::numbers::pi));
  add_noise(record.samples, 0.007, draw);
  return record;
}

Record quantised(Random& draw) {
  Record record = plain(50, 0.01, 517, 6);
  add_decay(record.samples, {50, 0.01}, 517, uniform(draw, 0, 2 * std::numbers::pi));
  const double step = 1.0 / uniform(draw, 90, 127);
  record.samples.array() += uniform(draw, -0.5, 0.5) * step;
  add_noise(record.samples, 0.1 * step, draw);
  record.samples = (record.samples / step).array().round().matrix() * step;
  return record;
}

Record jittered(Random& draw) {
  Record record = plain(50, 0.01, 1000, 1);
  const double w = 2 * std::numbers::pi * 50, phase = uniform(draw, 0, 6.28);
  std::normal_distribution<double> normal(0, 2e-5);
  for (Index j = 0; j < record.samples.size(); ++j) {
    const double t = static_cast<double>(j) / 1000 + normal(draw);
    record.samples(j) = std::exp(-0.01 * w * t) * std::cos(w * std::sqrt(1 - 1e-4) * t + phase);
  }
  add_noise(record.samples, 0.001, draw);
  return record;
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {
      {"hum within 1 Hz, damping 0.002, 1 s after 0.5 s of quiet",
       [](Random& r) { return with_hum(0.002, 1, 0.5, r); }},
      {"hum within 1 Hz, damping 0.017, 0.4 s after 0.5 s",
       [](Random& r) { return with_hum(0.017, 0.4, 0.5, r); }},
      {"hum within 1 Hz, damping 0.017, 3 s, no quiet",
       [](Random& r) { return with_hum(0.017, 3, 0, r); }},
      {"hum within 1 Hz, damping 0.005, 1 s, no quiet",
       [](Random& r) { return with_hum(0.005, 1, 0, r); }},
      {"8 bits, 10 samples a cycle, long", quantised},
      {"sampling jitter of 20 us", jittered},
  };
  return all;
}

void decay(const Kind& kind, std::uint64_t seed, study::Table& table) {
  Random draw(seed);
  const Record record = kind.make(draw);
  const auto [result, seconds] =
      study::timed([&] { return signal::estimate_decay(record.samples, record.rate_hz); });
  table.add("median ms", 1e3 * seconds);
  bool sure = result.refusal_code.empty();
  if (!sure) table.add("refused", result.refusal_code);
  for (const auto& note : result.notes) {
    // What says that the numbers are not those of one decay; the others are ordinary.
    for (const char* code : {"not_one_decay", "not_exponential", "damping_not_resolved"}) {
      if (note.code == code) table.add("warned", note.code), sure = false;
    }
  }
  table.add("without warning, %", sure);
  if (!sure) return;
  table.add("too many modes", result.modes.size() > 1);
  const auto& mode = *std::ranges::min_element(result.modes, {}, [&](const auto& one) {
    return std::abs(one.frequency_hz.value - record.frequency_hz);
  });
  table.add("f held, %", study::held(mode.frequency_interval_95_hz, record.frequency_hz));
  table.add("damping held, %", study::held(mode.damping_ratio_interval_95, record.damping_ratio));
}

}  // namespace

int main(int argc, char** argv) {
  using enum study::Of;
  study::run(study::arguments(argc, argv, 100),
             {"record",
              {{"f held, %"},
               {"damping held, %"},
               {"without warning, %"},
               {"refused", codes},
               {"warned", codes},
               {"too many modes", sum},
               {"median ms", median}}},
             kinds(), decay);
}
