// Long free decays with known truth: errors of `estimate_decay` over the Cramer-Rao bound, coverage
// of its 95 % intervals, and what it refuses. The phase is drawn anew; an offset and a drift are on
// every record.
#include "signal/decay/decay.h"
#include "signal/sinusoids/damped_sinusoids.h"
#include "tests/bench/study.h"
#include "tests/signal/decays.h"

namespace {

using namespace rigfit;

constexpr double kRate = 1000;
constexpr Index kSamples = 1 << 16;
constexpr rigfit::testing::DecayingMode kMode{5.4, 0.0024};

struct Case {
  std::string name;
  double snr_db;  // power of the mode at the start over the noise's
  bool in_band;   // a band around the mode is asked for
};

void decay(const Case& c, std::uint64_t seed, study::Table& table) {
  const double sigma = std::sqrt(0.5 * std::pow(10, -c.snr_db / 10));
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
  Eigen::VectorXd y = Eigen::VectorXd::Zero(kSamples);
  rigfit::testing::add_decay(y, kMode, kRate, angle(generator));
  // The bound at this phase, from the Gram matrix at the truth of the noise-free record.
  const Complex pole = rigfit::testing::pole(kMode, kRate);
  const auto truth = signal::fit_damped_sinusoids(y, {&pole, 1}, {.max_iterations = 0});
  y += Eigen::VectorXd::LinSpaced(kSamples, 0.3, 0.4);
  rigfit::testing::add_noise(y, sigma, generator);
  signal::DecayOptions options;
  if (c.in_band) options.band_low_hz = 0.7 * kMode.f, options.band_high_hz = 1.4 * kMode.f;
  const auto [result, seconds] =
      study::timed([&] { return signal::estimate_decay(y, kRate, options); });
  table.add("median ms", 1e3 * seconds);
  table.add("refused", !result.refusal_code.empty());
  if (!result.refusal_code.empty() || truth.unit_covariance.size() == 0) return;
  const auto& mode = result.modes.front();
  table.add("f held, %", study::held(mode.frequency_interval_95_hz, kMode.f));
  table.add("damping held, %", study::held(mode.damping_ratio_interval_95, kMode.zeta));
  const double s = pole.real(), w = pole.imag(), r = std::abs(pole);
  const Eigen::Vector2d jf(s / r, w / r), jz(-w * w / (r * r * r), s * w / (r * r * r));
  const Eigen::Matrix2d v = sigma * sigma * truth.unit_covariance.block<2, 2>(2, 2);
  table.add("f: error / CRB, rms", 2 * std::numbers::pi * (mode.frequency_hz.value - kMode.f) /
                                       kRate / std::sqrt(jf.dot(v * jf)));
  table.add("damping: error / CRB, rms",
            (mode.damping_ratio.value - kMode.zeta) / std::sqrt(jz.dot(v * jz)));
}

}  // namespace

int main(int argc, char** argv) {
  using enum study::Of;
  const Case cases[] = {{"5.4 Hz, damping 0.0024, 10 dB", 10, false},
                        {"the same, in its band, 10 dB", 10, true}};
  study::run(study::arguments(argc, argv, 20),
             {"decay",
              {{"f: error / CRB, rms", rms},
               {"f held, %"},
               {"damping: error / CRB, rms", rms},
               {"damping held, %"},
               {"refused", sum},
               {"median ms", median}}},
             cases, decay);
}
