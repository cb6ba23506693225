// Free decays with known truth: scatter and bias of `estimate_decay` against the Cramer-Rao bound,
// coverage of its 95 % intervals, and what it refuses. Prints Markdown tables; the first argument
// is the number of noise seeds a row (1000).
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "signal/decay/decay.h"
#include "signal/sinusoids/damped_sinusoids.h"

namespace {

using rigfit::signal::DecayResult;
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

DecayResult estimate(const Eigen::VectorXd& y, const Case& c) {
  rigfit::signal::DecayOptions options;
  if (c.in_band) {
    options.band_low_hz = 0.7 * c.modes[0].frequency_hz;
    options.band_high_hz = 1.4 * c.modes[0].frequency_hz;
  }
  return rigfit::signal::estimate_decay(y, c.rate_hz, options);
}

Complex pole(const Mode& mode, double rate) {
  const double w = 2 * std::numbers::pi * mode.frequency_hz / rate;
  return {-mode.damping_ratio * w, w * std::sqrt(1 - mode.damping_ratio * mode.damping_ratio)};
}

void row(const Case& c, int seeds) {
  const auto n = static_cast<Index>(std::lround(c.duration_s * c.rate_hz));
  const double sigma = c.modes[0].amplitude * std::sqrt(0.5 * std::pow(10, -c.snr_db / 10));
  double f2 = 0, z2 = 0, f1 = 0, z1 = 0, crb_f = 0, crb_z = 0;
  int given = 0, f_in = 0, z_in = 0, right_count = 0;
  std::map<std::string, int> refusals;
  std::vector<double> times;
  for (int seed = 0; seed < seeds; ++seed) {
    std::mt19937_64 generator(static_cast<std::uint64_t>(seed) + 1);
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
    rigfit::signal::DampedSinusoidsOptions at_truth;
    at_truth.max_iterations = 0;
    const auto truth = rigfit::signal::fit_damped_sinusoids(y, poles, at_truth);
    const double scale = std::sqrt(1 - c.colour * c.colour);  // keeps the noise's variance
    double noise = normal(generator);
    for (Index j = 0; j < n; ++j) {
      y(j) += 0.3 + 0.1 * static_cast<double>(j) / static_cast<double>(n) + sigma * noise;
      noise = c.colour * noise + scale * normal(generator);
    }
    const auto start = std::chrono::steady_clock::now();
    const DecayResult result = estimate(y, c);
    times.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    if (!result.refusal_code.empty()) {
      ++refusals[result.refusal_code];
      continue;
    }
    ++given;
    right_count += result.modes.size() == c.modes.size();
    const auto* best = &result.modes[0];
    for (const auto& m : result.modes) {
      if (std::abs(m.frequency_hz.value - c.modes[0].frequency_hz) <
          std::abs(best->frequency_hz.value - c.modes[0].frequency_hz)) {
        best = &m;
      }
    }
    const double df = best->frequency_hz.value - c.modes[0].frequency_hz;
    const double dz = best->damping_ratio.value - c.modes[0].damping_ratio;
    f1 += df, f2 += df * df, z1 += dz, z2 += dz * dz;
    const auto holds = [](const rigfit::signal::Interval& interval, double truth_value) {
      return interval.low <= truth_value && truth_value <= interval.high;
    };
    f_in += holds(best->frequency_interval_95_hz, c.modes[0].frequency_hz);
    z_in += holds(best->damping_ratio_interval_95, c.modes[0].damping_ratio);
    if (truth.unit_covariance.size() > 0) {
      const double s = poles[0].real(), w = poles[0].imag(), r = std::abs(poles[0]);
      Eigen::Vector2d jf(s / r, w / r), jz(-w * w / (r * r * r), s * w / (r * r * r));
      const Eigen::Matrix2d v = sigma * sigma * truth.unit_covariance.block<2, 2>(2, 2);
      const double to_hz = c.rate_hz / (2 * std::numbers::pi);
      crb_f += to_hz * to_hz * jf.dot(v * jf), crb_z += jz.dot(v * jz);
    }
  }
  std::nth_element(times.begin(), times.begin() + static_cast<long>(times.size() / 2), times.end());
  std::string refused;
  for (const auto& [code, count] : refusals)
    refused += (refused.empty() ? "" : ", ") + code + " " + std::to_string(count);
  if (given == 0) {
    std::printf("| %s | %g | - | - | - | - | - | - | - | %s | %.2f |\n", c.name.c_str(), c.snr_db,
                refused.c_str(), 1e3 * times[times.size() / 2]);
    return;
  }
  const double k = given;
  const double bf = std::sqrt(crb_f / k), bz = std::sqrt(crb_z / k);
  const auto scatter = [&](double s1, double s2) {
    return std::sqrt(std::max(0.0, s2 / k - s1 / k * (s1 / k)));
  };
  std::printf("| %s | %g | %.3f | %+.3f | %.1f | %.3f | %+.3f | %.1f | %.1f | %s | %.2f |\n",
              c.name.c_str(), c.snr_db, scatter(f1, f2) / bf, f1 / k / bf, 100.0 * f_in / k,
              scatter(z1, z2) / bz, z1 / k / bz, 100.0 * z_in / k, 100.0 * right_count / k,
              refused.empty() ? "-" : refused.c_str(), 1e3 * times[times.size() / 2]);
  std::fflush(stdout);
}

void head(const char* title) {
  std::printf(
      "\n%s\n\n| decay | SNR dB | f: scatter/CRB | bias/CRB | covered %% | damping: scatter/CRB | "
      "bias/CRB | covered %% | right number of modes %% | refused | median ms |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n",
      title);
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::max(2, std::atoi(argv[1])) : 1000;
  std::printf(
      "%d noise seeds a row; phase of every mode drawn anew; offset and drift on every record\n",
      seeds);
  head("The axial test: 50 Hz, 500 Hz sampling, damping 0.017, 1 s");
  for (double snr : {-3.0, 0.0, 3.0, 6.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0}) {
    // At -3 dB nine in ten are refused.
    row({"axial test", {{50, 0.017, 1}}, 500, 1, snr}, snr < 0 ? 5 * seeds : seeds);
  }
  head("From light to heavy damping, few to many cycles, few to many samples a cycle");
  const int fewer = std::max(2, seeds / 5);
  row({"axial, red noise (AR 0.9)", {{50, 0.017, 1}}, 500, 1, 20, 0.9}, fewer);
  row({"axial, blue noise (AR -0.6)", {{50, 0.017, 1}}, 500, 1, 20, -0.6}, fewer);
  row({"axial", {{50, 0.017, 1}}, 500, 1, 80}, fewer);
  row({"damping 1e-4, 50 cycles", {{50, 1e-4, 1}}, 500, 1, 40}, fewer);
  row({"damping 1e-4, 10000 cycles", {{50, 1e-4, 1}}, 500, 200, 20}, std::max(2, seeds / 50));
  row({"damping 1e-4, 2 cycles", {{50, 1e-4, 1}}, 500, 0.04, 40}, fewer);
  row({"damping 0.1, 5 cycles", {{50, 0.1, 1}}, 500, 0.1, 40}, fewer);
  row({"damping 0.3, 3 cycles", {{50, 0.3, 1}}, 2000, 0.06, 40}, fewer);
  row({"damping 0.5, 2 cycles", {{50, 0.5, 1}}, 2000, 0.04, 60}, fewer);
  row({"damping 0.3, 5 cycles", {{50, 0.3, 1}}, 2000, 0.1, 8}, fewer);
  row({"damping 0.5, 10 cycles", {{50, 0.5, 1}}, 2000, 0.2, 20}, fewer);
  row({"damping 0.5, 10 cycles", {{50, 0.5, 1}}, 2000, 0.2, 40}, fewer);
  row({"damping 0.017, 2 cycles", {{50, 0.017, 1}}, 500, 0.04, 40}, fewer);
  row({"2.1 samples a cycle", {{50, 0.005, 1}}, 105, 4, 30}, fewer);
  row({"1000 samples a cycle", {{1, 0.01, 1}}, 1000, 20, 30}, fewer);
  row({"1000 samples a cycle, 2 cycles", {{1, 0.01, 1}}, 1000, 2, 40}, fewer);
  row({"0.2 cycles", {{1, 0.01, 1}}, 1000, 0.2, 60}, fewer);
  row({"noise alone", {{50, 0.017, 1e-9}}, 500, 1, -100}, fewer);
  row({"red noise alone (AR 0.9)", {{50, 0.017, 1e-9}}, 500, 1, -100, 0.9}, fewer);
  head("Pairs (figures are of the first mode)");
  row({"beat 50 + 51 Hz", {{50, 0.003, 1}, {51, 0.003, 0.8}}, 500, 4, 30}, fewer);
  row({"beat 50 + 50.5 Hz", {{50, 0.002, 1}, {50.5, 0.002, 1}}, 500, 4, 40}, fewer);
  row({"50 + 120 Hz, 1 : 0.01", {{50, 0.017, 1}, {120, 0.01, 0.01}}, 500, 1, 50}, fewer);
  row({"50 + 55 Hz, heavy", {{50, 0.03, 1}, {55, 0.03, 0.7}}, 500, 1, 40}, fewer);
  head("65536 samples, whole and with a band asked for");
  for (const double snr : {-10.0, 10.0, 40.0}) {
    const Case whole{"5.4 Hz, damping 0.0024", {{5.4, 0.0024, 1}}, 1000, 65.536, snr};
    Case in_band = whole;
    in_band.name += ", in its band", in_band.in_band = true;
    row(whole, fewer);
    row(in_band, fewer);
  }
  Case pair{"5.4 + 5.6 Hz", {{5.4, 0.0024, 1}, {5.6, 0.0024, 0.5}}, 1000, 65.536, 10};
  row(pair, fewer);
  pair.name += ", in their band", pair.in_band = true;
  row(pair, fewer);
  return 0;
}
