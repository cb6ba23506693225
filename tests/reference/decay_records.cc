#include "tests/reference/decay_records.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

namespace rigfit::decay_records {
namespace {

using Eigen::Index;

double uniform(Random& draw, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(draw);
}

struct Hit {
  double time_s, impulse;  ///< change of velocity over w: amplitude of displacement
  double lasts_s = 0;      ///< half-sine
};

/// x'' + 2 zeta w x' + w^2 x = w (impulses + noise), sampled; steps of a tenth of a sample under
/// the force, by the exact transition over each.
class Oscillator {
 public:
  Oscillator(double frequency_hz, double damping_ratio)
      : w_(2 * std::numbers::pi * frequency_hz), zeta_(damping_ratio) {}

  double x = 0, v = 0;  ///< v: velocity over w

  [[nodiscard]] Eigen::VectorXd run(Index samples, double rate, const std::vector<Hit>& hits,
                                    double driven, Random& draw) {
    constexpr int kSteps = 10;
    const double h = 1 / rate / kSteps;
    const double wd = w_ * std::sqrt(1 - zeta_ * zeta_), fall = std::exp(-zeta_ * w_ * h);
    const double c = std::cos(wd * h), s = std::sin(wd * h), q = zeta_ * w_ / wd, r = w_ / wd;
    std::normal_distribution<double> normal;
    Eigen::VectorXd out(samples);
    for (Index j = 0; j < samples; ++j) {
      out(j) = x;
      for (int k = 0; k < kSteps; ++k) {
        const double t = (static_cast<double>(j) + static_cast<double>(k) / kSteps) / rate;
        for (const Hit& hit : hits) {
          if (hit.lasts_s <= h) {
            if (t <= hit.time_s && hit.time_s < t + h) v += hit.impulse;
          } else if (t >= hit.time_s && t < hit.time_s + hit.lasts_s) {
            v += hit.impulse * h * 0.5 * std::numbers::pi / hit.lasts_s *
                 std::sin(std::numbers::pi * (t - hit.time_s) / hit.lasts_s);
          }
        }
        if (driven > 0) v += driven * std::sqrt(w_ * h) * normal(draw);
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

double noise_at(double db) { return std::sqrt(0.5 * std::pow(10, -db / 10)); }

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

Record released(double f, double zeta, double rate, double seconds, Random& draw) {
  Record record = plain(f, zeta, rate, seconds);
  Oscillator o(f, zeta);
  const double phase = uniform(draw, 0, 2 * std::numbers::pi);
  o.x = std::cos(phase), o.v = std::sin(phase);
  record.samples = o.run(record.samples.size(), rate, {}, 0, draw);
  return record;
}

Record struck_twice(double share, double snr_db, Random& draw) {
  Record record = plain(5, 0.01, 100, 40);
  Oscillator o(5, 0.01);
  const double first = uniform(draw, 1, 3), second = first + uniform(draw, 5, 20);
  record.samples =
      o.run(record.samples.size(), 100, {{first, 1, 0.02}, {second, share, 0.02}}, 0, draw);
  add_noise(record.samples, noise_at(snr_db), draw);
  return record;
}

Record struck_often(Random& draw) {
  Record record = plain(12, 0.008, 200, 60);
  Oscillator o(12, 0.008), other(31, 0.006);
  std::vector<Hit> hits;
  for (double t = uniform(draw, 0.5, 2); t < 55; t += uniform(draw, 6, 14)) {
    hits.push_back({t, uniform(draw, 0.4, 1), 0.01});
  }
  record.samples = o.run(record.samples.size(), 200, hits, 0, draw) +
                   0.3 * other.run(record.samples.size(), 200, hits, 0, draw);
  add_noise(record.samples, 0.005, draw);
  record.modes = 2;
  return record;
}

/// Under white noise; scaled to unit variance.
Record driven(double f, double zeta, double rate, double seconds, double noise, Random& draw) {
  Record record = plain(f, zeta, rate, seconds);
  Oscillator o(f, zeta), other(2.7 * f, zeta);
  (void)o.run(static_cast<Index>(rate / (zeta * f)), rate, {}, 1, draw);
  record.samples = o.run(record.samples.size(), rate, {}, 1, draw) +
                   0.2 * other.run(record.samples.size(), rate, {}, 1, draw);
  record.samples /=
      std::sqrt(record.samples.squaredNorm() / static_cast<double>(record.samples.size()));
  add_noise(record.samples, noise, draw);
  record.frequency_hz = 0;
  return record;
}

Record with_hum(double zeta, double seconds, double quiet_s, Random& draw) {
  const double f = 50 + (uniform(draw, 0, 1) < 0.5 ? -1 : 1) * uniform(draw, 0.2, 1.0);
  Record record = plain(f, zeta, 1000, quiet_s + seconds);
  Oscillator o(f, zeta);
  if (quiet_s == 0) {
    const double phase = uniform(draw, 0, 2 * std::numbers::pi);
    o.x = std::cos(phase), o.v = std::sin(phase);
  }
  const std::vector<Hit> hits =
      quiet_s > 0 ? std::vector<Hit>{{quiet_s, 1, 0.002}} : std::vector<Hit>{};
  record.samples = o.run(record.samples.size(), 1000, hits, 0, draw);
  add_tone(record.samples, 0.05, 0.05, draw);
  add_noise(record.samples, 0.007, draw);
  return record;
}

Record two_modes(double apart, double share, double zeta, double db, Random& draw) {
  Record record = released(50, zeta, 500, 1, draw);
  record.samples += share * released(50 * (1 + apart), zeta, 500, 1, draw).samples;
  add_noise(record.samples, noise_at(db), draw);
  record.modes = 2;
  return record;
}

Record quantised(double noise_steps, double f, double rate, double seconds, Random& draw) {
  Record record = released(f, 0.01, rate, seconds, draw);
  const double step = 1.0 / uniform(draw, 90, 127);
  record.samples.array() += uniform(draw, -0.5, 0.5) * step;
  add_noise(record.samples, noise_steps * step, draw);
  record.samples = (record.samples / step).array().round().matrix() * step;
  return record;
}

Record heavy(double zeta, double noise, double rate, double cycles, Random& draw) {
  Record record = released(3.64, zeta, rate, cycles / 3.64, draw);
  if (noise > 0) add_noise(record.samples, noise, draw);
  return record;
}

Record stopped(double stop_s, Random& draw) {
  Record record = plain(20, 0.01, 500, 6);
  Oscillator o(20, 0.01);
  record.samples =
      o.run(record.samples.size(), 500, {{uniform(draw, 0.3, 0.8), 1, 0.005}}, 0, draw);
  record.samples.array() += 0.2;
  add_noise(record.samples, 0.005, draw);
  record.samples.tail(record.samples.size() - static_cast<Index>(stop_s * 500)).setZero();
  return record;
}

/// x'' + 2 zeta w x' + w^2 (x + friction sign(x')) = 0.
Record rubbed(double friction, Random& draw) {
  Record record = plain(5, 0.004, 200, 20);
  const double w = 2 * std::numbers::pi * 5, h = 1 / 200.0 / 20;
  Eigen::Vector2d state(1, 0);
  const auto slope = [&](const Eigen::Vector2d& s) {
    const double sign = std::tanh(s(1) / 1e-3);
    return Eigen::Vector2d(w * s(1), -w * (s(0) + 0.008 * s(1) + friction * sign));
  };
  for (Index j = 0; j < record.samples.size(); ++j) {
    record.samples(j) = state(0);
    for (int k = 0; k < 20; ++k) {
      const Eigen::Vector2d a = slope(state), b = slope(state + 0.5 * h * a),
                            c = slope(state + 0.5 * h * b), d = slope(state + h * c);
      state += h / 6 * (a + 2 * b + 2 * c + d);
    }
  }
  add_noise(record.samples, 0.002, draw);
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

Record swinging(double swing, Random& draw) {
  Record record = plain(50, 0.017, 500, 4);
  Oscillator axial(50, 0.017), pendulum(0.6, 0.005);
  const double phase = uniform(draw, 0, 2 * std::numbers::pi);
  pendulum.x = swing * std::cos(phase), pendulum.v = swing * std::sin(phase);
  record.samples =
      axial.run(record.samples.size(), 500, {{uniform(draw, 0.5, 2), 1, 0.002}}, 0, draw) +
      pendulum.run(record.samples.size(), 500, {}, 0, draw);
  add_noise(record.samples, 0.007, draw);
  record.options.band_low_hz = 30, record.options.band_high_hz = 80;
  return record;
}

}  // namespace

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {
      {"second hit of 0.1 of the first, 40 dB", [](Random& r) { return struck_twice(0.1, 40, r); }},
      {"second hit of 0.2, 30 dB", [](Random& r) { return struck_twice(0.2, 30, r); }},
      {"second hit of 0.5, 20 dB", [](Random& r) { return struck_twice(0.5, 20, r); }},
      {"second hit of 1, 60 dB", [](Random& r) { return struck_twice(1, 60, r); }},
      {"hits every 6 to 14 s, two modes", struck_often},
      {"driven, 5.433 Hz, damping 0.003, 300 s",
       [](Random& r) { return driven(5.433, 0.003, 50, 300, 0.05, r); }},
      {"driven, damping 0.003, 60 s",
       [](Random& r) { return driven(5.433, 0.003, 50, 60, 0.05, r); }},
      {"driven, damping 0.003, 20 s",
       [](Random& r) { return driven(5.433, 0.003, 50, 20, 0.01, r); }},
      {"driven, damping 0.02, 100 s",
       [](Random& r) { return driven(5.433, 0.02, 50, 100, 0.05, r); }},
      {"hum within 1 Hz, damping 0.002, 1 s after 0.5 s of quiet",
       [](Random& r) { return with_hum(0.002, 1, 0.5, r); }},
      {"hum within 1 Hz, damping 0.017, 0.4 s after 0.5 s",
       [](Random& r) { return with_hum(0.017, 0.4, 0.5, r); }},
      {"hum within 1 Hz, damping 0.017, 3 s, no quiet",
       [](Random& r) { return with_hum(0.017, 3, 0, r); }},
      {"hum within 1 Hz, damping 0.005, 1 s, no quiet",
       [](Random& r) { return with_hum(0.005, 1, 0, r); }},
      {"mode 2 % off, 10 %, 40 dB, damping 0.017",
       [](Random& r) { return two_modes(0.02, 0.1, 0.017, 40, r); }},
      {"mode 2 % off, 10 %, 40 dB, damping 0.005",
       [](Random& r) { return two_modes(0.02, 0.1, 0.005, 40, r); }},
      {"mode 4 % off, 30 %, 30 dB, damping 0.017",
       [](Random& r) { return two_modes(0.04, 0.3, 0.017, 30, r); }},
      {"8 bits, no noise", [](Random& r) { return quantised(0, 50, 1000, 2, r); }},
      {"8 bits, noise 0.2 steps", [](Random& r) { return quantised(0.2, 50, 1000, 2, r); }},
      {"8 bits, 10 samples a cycle, long", [](Random& r) { return quantised(0.1, 50, 517, 6, r); }},
      {"8 bits, 400 samples a cycle", [](Random& r) { return quantised(0.05, 2.5, 1000, 20, r); }},
      {"damping 0.42, clean, 10 cycles", [](Random& r) { return heavy(0.42, 1e-6, 200, 10, r); }},
      {"damping 0.42, 40 dB", [](Random& r) { return heavy(0.42, 0.007, 500, 20, r); }},
      {"damping 0.6, clean, 20 cycles", [](Random& r) { return heavy(0.6, 1e-5, 1000, 20, r); }},
      {"damping 0.6, 50 dB", [](Random& r) { return heavy(0.6, 0.002, 200, 5, r); }},
      {"damping 0.2, 40 dB", [](Random& r) { return heavy(0.2, 0.007, 100, 15, r); }},
      {"zeros at the end, amid the decay", [](Random& r) { return stopped(1.7, r); }},
      {"zeros at the end, after the decay", [](Random& r) { return stopped(5, r); }},
      {"friction of 0.003", [](Random& r) { return rubbed(0.003, r); }},
      {"friction of 0.02", [](Random& r) { return rubbed(0.02, r); }},
      {"sampling jitter of 20 us", jittered},
      {"pendulum of 3 amplitudes outside of the band", [](Random& r) { return swinging(3, r); }},
      {"pendulum of 0.5 amplitudes outside of the band",
       [](Random& r) { return swinging(0.5, r); }},
  };
  return all;
}

Tally study(const Kind& kind, int records) {
  Tally tally;
  std::vector<double> times;
  for (int i = 0; i < records; ++i) {
    Random draw(static_cast<std::uint64_t>(i) + 1);
    const Record record = kind.make(draw);
    const auto start = std::chrono::steady_clock::now();
    const auto result = signal::estimate_decay(record.samples, record.rate_hz, record.options);
    times.push_back(
        1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    ++tally.records;
    if (!result.refusal_code.empty()) {
      ++tally.refused[result.refusal_code];
      continue;
    }
    bool warned = false;
    for (const auto& note : result.notes) {
      // What says that the numbers are not those of one decay; the others are ordinary.
      for (const char* code :
           {"not_one_decay", "not_exponential", "damping_not_resolved", "clipped"}) {
        if (note.code == code) ++tally.warned[code], warned = warned || note.code != "clipped";
      }
    }
    for (const auto& mode : result.modes) {
      if (!(mode.damping_ratio.value >= 0)) ++tally.wrong;
    }
    if (record.frequency_hz == 0) {
      ++tally.wrong;
      continue;
    }
    if (warned) continue;
    ++tally.sure;
    tally.more_modes += result.modes.size() > record.modes;
    const auto& mode = *std::min_element(
        result.modes.begin(), result.modes.end(), [&](const auto& a, const auto& b) {
          return std::abs(a.frequency_hz.value - record.frequency_hz) <
                 std::abs(b.frequency_hz.value - record.frequency_hz);
        });
    const auto holds = [](const signal::Interval& interval, double truth) {
      return interval.low <= truth && truth <= interval.high;
    };
    tally.frequency_held += holds(mode.frequency_interval_95_hz, record.frequency_hz);
    tally.damping_held += holds(mode.damping_ratio_interval_95, record.damping_ratio);
  }
  std::nth_element(times.begin(), times.begin() + static_cast<long>(times.size() / 2), times.end());
  tally.median_ms = times[times.size() / 2];
  return tally;
}

std::string Tally::row(const std::string& name) const {
  const auto share = [](int part, int whole) {
    return whole > 0 ? fmt::format("{:.1f}", 100.0 * part / whole) : std::string("-");
  };
  const auto list = [](const std::map<std::string, int>& codes) {
    std::string text;
    for (const auto& [code, count] : codes) {
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", code, count);
    }
    return text.empty() ? std::string("-") : text;
  };
  return fmt::format("| {} | {} | {} | {} | {} | {}{} | {} | {:.2f} |", name,
                     share(frequency_held, sure), share(damping_held, sure), share(sure, records),
                     list(refused), list(warned), wrong > 0 ? fmt::format(", WRONG {}", wrong) : "",
                     more_modes, median_ms);
}

}  // namespace rigfit::decay_records
