// Free decays with known truth: errors of `estimate_decay` over the Cramer-Rao bound, coverage of
// its 95 % intervals, and what it refuses. The phase of every mode is drawn anew; an offset and a
// drift are on every record. Figures of pairs are those of the first mode.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "signal/decay/decay.h"
#include "signal/sinusoids/damped_sinusoids.h"
#include "tests/bench/study.h"

namespace {

using namespace rigfit;
using Complex = std::complex<double>;
using Eigen::Index;

struct Mode {
  double frequency_hz, damping_ratio, amplitude;
};

struct Case {
  std::string name;
  std::vector<Mode> modes;
  double rate_hz, duration_s, snr_db;  // power of the first mode at the start over the noise's
  double colour = 0;                   // noise n_j = colour n_{j-1} + e_j
  bool in_band = false;                // a band around the first mode is asked for
};

signal::DecayResult estimate(const Eigen::VectorXd& y, const Case& c) {
  signal::DecayOptions options;
  if (c.in_band) {
    options.band_low_hz = 0.7 * c.modes[0].frequency_hz;
    options.band_high_hz = 1.4 * c.modes[0].frequency_hz;
  }
  return signal::estimate_decay(y, c.rate_hz, options);
}

Complex pole(const Mode& mode, double rate) {
  const double w = 2 * std::numbers::pi * mode.frequency_hz / rate;
  return {-mode.damping_ratio * w, w * std::sqrt(1 - mode.damping_ratio * mode.damping_ratio)};
}

void decay(const Case& c, std::uint64_t seed, study::Table& table) {
  const auto n = static_cast<Index>(std::lround(c.duration_s * c.rate_hz));
  const double sigma = c.modes[0].amplitude * std::sqrt(0.5 * std::pow(10, -c.snr_db / 10));
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
  Eigen::VectorXd y = Eigen::VectorXd::Zero(n);
  std::vector<Complex> poles;
  for (const auto& mode : c.modes) {
    poles.push_back(pole(mode, c.rate_hz));
    const Complex a = std::polar(mode.amplitude, angle(generator));
    for (Index j = 0; j < n; ++j)
      y(j) += (a * std::exp(poles.back() * static_cast<double>(j))).real();
  }
  // The bound at this phase, from the Gram matrix at the truth of the noise-free record.
  const auto truth = signal::fit_damped_sinusoids(y, poles, {.max_iterations = 0});
  const double scale = std::sqrt(1 - c.colour * c.colour);  // keeps the noise's variance
  double noise = normal(generator);
  for (Index j = 0; j < n; ++j) {
    y(j) += 0.3 + 0.1 * static_cast<double>(j) / static_cast<double>(n) + sigma * noise;
    noise = c.colour * noise + scale * normal(generator);
  }
  const auto [result, seconds] = study::timed([&] { return estimate(y, c); });
  table.add("median ms", 1e3 * seconds);
  if (!result.refusal_code.empty()) {
    table.add("refused", result.refusal_code);
    return;
  }
  table.add("right number of modes, %", result.modes.size() == c.modes.size());
  const double f = c.modes[0].frequency_hz, zeta = c.modes[0].damping_ratio;
  const auto& best = *std::ranges::min_element(
      result.modes, {}, [&](const auto& mode) { return std::abs(mode.frequency_hz.value - f); });
  table.add("f held, %", study::held(best.frequency_interval_95_hz, f));
  table.add("damping held, %", study::held(best.damping_ratio_interval_95, zeta));
  if (truth.unit_covariance.size() == 0) return;
  const double s = poles[0].real(), w = poles[0].imag(), r = std::abs(poles[0]);
  const Eigen::Vector2d jf(s / r, w / r), jz(-w * w / (r * r * r), s * w / (r * r * r));
  const Eigen::Matrix2d v = sigma * sigma * truth.unit_covariance.block<2, 2>(2, 2);
  const double df = 2 * std::numbers::pi * (best.frequency_hz.value - f) / c.rate_hz;
  const double dz = best.damping_ratio.value - zeta;
  for (const char* column : {"f: error / bound, rms", "mean"})
    table.add(column, df / std::sqrt(jf.dot(v * jf)));
  for (const char* column : {"damping: error / bound, rms", "its mean"})
    table.add(column, dz / std::sqrt(jz.dot(v * jz)));
}

std::vector<Case> cases() {
  const std::vector<Mode> axial{{50, 0.017, 1}}, nothing{{50, 0.017, 1e-9}};
  std::vector<Case> all;
  for (const double snr : {10.0, 20.0, 40.0, 60.0, 80.0}) {
    all.push_back({"axial test: 50 Hz, 500 Hz sampling, damping 0.017, 1 s", axial, 500, 1, snr});
  }
  const Case others[] = {
      {"axial, red noise (AR 0.9)", axial, 500, 1, 20, 0.9},
      {"axial, blue noise (AR -0.6)", axial, 500, 1, 20, -0.6},
      {"damping 1e-4, 10000 cycles", {{50, 1e-4, 1}}, 500, 200, 20},
      {"damping 1e-4, 2 cycles", {{50, 1e-4, 1}}, 500, 0.04, 40},
      {"damping 0.5, 2 cycles", {{50, 0.5, 1}}, 2000, 0.04, 60},
      {"damping 0.5, 10 cycles", {{50, 0.5, 1}}, 2000, 0.2, 20},
      {"damping 0.5, 10 cycles", {{50, 0.5, 1}}, 2000, 0.2, 40},
      {"2.1 samples a cycle", {{50, 0.005, 1}}, 105, 4, 30},
      {"1000 samples a cycle", {{1, 0.01, 1}}, 1000, 20, 30},
      {"0.2 cycles", {{1, 0.01, 1}}, 1000, 0.2, 60},
      {"white noise alone", nothing, 500, 1, -100},
      {"red noise alone (AR 0.9)", nothing, 500, 1, -100, 0.9},
      {"beat 50 + 51 Hz", {{50, 0.003, 1}, {51, 0.003, 0.8}}, 500, 4, 30},
      {"50 + 120 Hz, 1 : 0.01", {{50, 0.017, 1}, {120, 0.01, 0.01}}, 500, 1, 50},
  };
  all.insert(all.end(), std::begin(others), std::end(others));
  for (const bool in_band : {false, true}) {
    const char* whole = in_band ? ", in its band" : "";
    for (const double snr : {10.0, 40.0}) {
      all.push_back({fmt::format("65536 samples, 5.4 Hz, damping 0.0024{}", whole),
                     {{5.4, 0.0024, 1}},
                     1000,
                     65.536,
                     snr,
                     0,
                     in_band});
    }
    all.push_back({fmt::format("65536 samples, 5.4 + 5.6 Hz{}", whole),
                   {{5.4, 0.0024, 1}, {5.6, 0.0024, 0.5}},
                   1000,
                   65.536,
                   10,
                   0,
                   in_band});
  }
  for (Case& one : all) one.name += fmt::format(", {:g} dB", one.snr_db);
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  using enum study::Of;
  study::run(study::arguments(argc, argv, 100),
             {"decay",
              {{"f: error / bound, rms", rms},
               {"mean", mean, "{:+.2f}"},
               {"f held, %"},
               {"damping: error / bound, rms", rms},
               {"its mean", mean, "{:+.2f}"},
               {"damping held, %"},
               {"right number of modes, %"},
               {"refused", codes},
               {"median ms", median}}},
             cases(), decay);
}
