// Free decays with what real records have beside them: mains hum, a converter's steps, jitter of
// the sampling clock. The records are integrated in time by the exact transition matrix,
// independently of the estimator's model. Intervals are those of the records that are answered
// without a warning.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "signal/decay/decay.h"
#include "tests/bench/study.h"

namespace {

using namespace rigfit;
using Eigen::Index;

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

struct Hit {
  double time_s, impulse;  ///< change of velocity over w: amplitude of displacement
  double lasts_s;          ///< half-sine
};

/// x'' + 2 zeta w x' + w^2 x = w impulses, sampled; steps of a tenth of a sample under
/// the force, by the exact transition over each.
class Oscillator {
 public:
  Oscillator(double frequency_hz, double damping_ratio)
      : w_(2 * std::numbers::pi * frequency_hz), zeta_(damping_ratio) {}

  double x = 0, v = 0;  ///< v: velocity over w

  /// From any phase.
  void let_go(Random& draw) {
    const double phase = uniform(draw, 0, 2 * std::numbers::pi);
    x = std::cos(phase), v = std::sin(phase);
  }

  [[nodiscard]] Eigen::VectorXd run(Index samples, double rate, const std::vector<Hit>& hits) {
    constexpr int kSteps = 10;
    const double h = 1 / rate / kSteps;
    const double wd = w_ * std::sqrt(1 - zeta_ * zeta_), fall = std::exp(-zeta_ * w_ * h);
    const double c = std::cos(wd * h), s = std::sin(wd * h), q = zeta_ * w_ / wd, r = w_ / wd;
    Eigen::VectorXd out(samples);
    for (Index j = 0; j < samples; ++j) {
      out(j) = x;
      for (int k = 0; k < kSteps; ++k) {
        const double t = (static_cast<double>(j) + static_cast<double>(k) / kSteps) / rate;
        for (const Hit& hit : hits) {
          if (t >= hit.time_s && t < hit.time_s + hit.lasts_s) {
            v += hit.impulse * h * 0.5 * std::numbers::pi / hit.lasts_s *
                 std::sin(std::numbers::pi * (t - hit.time_s) / hit.lasts_s);
          }
        }
        const double x0 = x, v0 = v;
        x = fall * (x0 * (c + q * s) + v0 * r * s);
        v = fall * (v0 * (c - q * s) - x0 * r * s);
      }
    }
    return out;
  }

 private:
  double w_, zeta_;
};

void add_noise(Eigen::VectorXd& y, double std, Random& draw) {
  std::normal_distribution<double> normal(0, std);
  for (double& value : y) value += normal(draw);
}

void add_tone(Eigen::VectorXd& y, double cycles_per_sample, double amplitude, Random& draw) {
  const double phase = uniform(draw, 0, 2 * std::numbers::pi);
  for (Index j = 0; j < y.size(); ++j) {
    y(j) += amplitude *
            std::cos(2 * std::numbers::pi * cycles_per_sample * static_cast<double>(j) + phase);
  }
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
  Oscillator o(f, zeta);
  if (quiet_s == 0) o.let_go(draw);
  const std::vector<Hit> hits =
      quiet_s > 0 ? std::vector<Hit>{{quiet_s, 1, 0.002}} : std::vector<Hit>{};
  record.samples = o.run(record.samples.size(), 1000, hits);
  add_tone(record.samples, 0.05, 0.05, draw);
  add_noise(record.samples, 0.007, draw);
  return record;
}

Record quantised(Random& draw) {
  Record record = plain(50, 0.01, 517, 6);
  Oscillator o(50, 0.01);
  o.let_go(draw);
  record.samples = o.run(record.samples.size(), 517, {});
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
