// Free decays with what real records have beside them: mains hum, a converter's steps, jitter of
// the sampling clock. Intervals are those of the records that are answered without a warning.
#include "signal/decay/decay.h"
#include "tests/bench/study.h"
#include "tests/signal/decays.h"

namespace {

using namespace rigfit;
using rigfit::testing::add_decay, rigfit::testing::add_noise;

using Random = std::mt19937_64;

double uniform(Random& draw, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(draw);
}

/// A decay that begins after `quiet_s`; without that, of any phase.
struct Record {
  Record(double f, double zeta, double rate, double seconds, Random& draw, double quiet_s = 0)
      : rate_hz(rate), frequency_hz(f), damping_ratio(zeta) {
    samples = Eigen::VectorXd::Zero(std::lround((quiet_s + seconds) * rate));
    add_decay(samples, {f, zeta}, rate, quiet_s > 0 ? -kPi / 2 : uniform(draw, 0, 2 * kPi),
              std::lround(rate * quiet_s));
  }
  Eigen::VectorXd samples;
  double rate_hz = 0, frequency_hz = 0, damping_ratio = 0;
};

struct Kind {
  std::string name;
  std::function<Record(Random&)> make;
};

auto with_hum(double zeta, double seconds, double quiet_s) {
  return [=](Random& draw) {
    const double f = 50 + (uniform(draw, 0, 1) < 0.5 ? -1 : 1) * uniform(draw, 0.2, 1.0);
    Record record(f, zeta, 1000, seconds, draw, quiet_s);
    add_decay(record.samples, {50, 0, 0.05}, 1000, uniform(draw, 0, 2 * kPi));
    add_noise(record.samples, 0.007, draw);
    return record;
  };
}

Record quantised(Random& draw) {
  Record record(50, 0.01, 517, 6, draw);
  const double step = 1.0 / uniform(draw, 90, 127);
  record.samples.array() += uniform(draw, -0.5, 0.5) * step;
  add_noise(record.samples, 0.1 * step, draw);
  record.samples = (record.samples / step).array().round().matrix() * step;
  return record;
}

Record jittered(Random& draw) {
  Record record(50, 0.01, 1000, 1, draw);
  const double w = 100 * kPi, phase = uniform(draw, 0, 6.28);
  std::normal_distribution<double> normal(0, 2e-5);
  for (Index j = 0; j < record.samples.size(); ++j) {
    const double t = static_cast<double>(j) / 1000 + normal(draw);
    record.samples(j) = std::exp(-0.01 * w * t) * std::cos(w * std::sqrt(1 - 1e-4) * t + phase);
  }
  add_noise(record.samples, 0.001, draw);
  return record;
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
  const Kind kinds[] = {
      {"hum within 1 Hz, damping 0.002, 1 s after 0.5 s of quiet", with_hum(0.002, 1, 0.5)},
      {"hum within 1 Hz, damping 0.017, 0.4 s after 0.5 s", with_hum(0.017, 0.4, 0.5)},
      {"hum within 1 Hz, damping 0.017, 3 s, no quiet", with_hum(0.017, 3, 0)},
      {"hum within 1 Hz, damping 0.005, 1 s, no quiet", with_hum(0.005, 1, 0)},
      {"8 bits, 10 samples a cycle, long", quantised},
      {"sampling jitter of 20 us", jittered},
  };
  study::run(study::arguments(argc, argv, 100),
             {"record",
              {{"f held, %"},
               {"damping held, %"},
               {"without warning, %"},
               {"refused", codes},
               {"warned", codes},
               {"too many modes", sum},
               {"median ms", median}}},
             kinds, decay);
}
