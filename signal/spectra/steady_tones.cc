#include "signal/spectra/steady_tones.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "signal/numerics/numbers.h"
#include "signal/numerics/power_sums.h"
#include "signal/spectra/fft.h"
#include "signal/spectra/window.h"

namespace rigfit::signal {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Complex = std::complex<double>;

constexpr int kBlocks = 16;
constexpr double kLeastPeriods = 8;     // periods in a block
constexpr double kLeastDamping = 1e-4;  // damping ratio of a resonance
constexpr double kRareWalk = 0.0174;    // omega^2 that is exceeded in 99.9 %
constexpr double kRarePowers = 0.2;     // variance of 16 exponential powers, the same
constexpr double kToneScatter = 2.04;   // chi-square of 15 degrees of freedom over 15, 99 %
constexpr std::size_t kMostLines = 40;  // looked at
constexpr double kWandering = 0.05;     // share of a tone's power that one sinusoid leaves

/// sum_i w_i x_i exp(-i omega i) / sum w, of what is left of the mean.
Complex amplitude_at(const Eigen::Ref<const VectorXd>& samples, const VectorXd& window,
                     double omega) {
  const double mean = samples.dot(window) / window.sum();
  const VectorXd left = (samples.array() - mean) * window.array();
  const Eigen::ArrayXcd turn = powers(Complex(0, -omega), samples.size());
  return (left.array() * turn).sum() / window.sum();
}

double variation_limit(double bandwidth_hz, double duration_s) {
  const double u = kTwoPi * bandwidth_hz * duration_s, walk = 2 * kRareWalk * u;
  return 0.5 * std::min(walk / (1 + walk / kRarePowers), u * u / 12);
}

/// The strongest sinusoid near `omega` by Gauss-Newton in frequency, amplitude and phase, samples
/// weighted by a Hann window.
struct Sinusoid {
  double omega = 0, in_phase = 0, quadrature = 0;
};

Sinusoid fitted_sinusoid(const Eigen::Ref<const VectorXd>& samples, double omega) {
  const Index n = samples.size();
  const VectorXd window = hann_window(n);
  const Complex start = 2.0 * amplitude_at(samples, window, omega);
  Sinusoid tone{omega, start.real(), -start.imag()};
  const double mean = samples.mean(), middle = static_cast<double>(n - 1) / 2;
  const Eigen::ArrayXd time =
      (Eigen::ArrayXd::LinSpaced(n, 0, static_cast<double>(n - 1)) - middle) /
      static_cast<double>(n);
  for (int step = 0; step < 6; ++step) {
    const Eigen::ArrayXcd turned = powers(Complex(0, tone.omega), n);
    const Eigen::ArrayXd c = turned.real(), s = turned.imag();
    Eigen::MatrixXd slopes(n, 3);
    slopes << c.matrix(), s.matrix(), ((tone.quadrature * c - tone.in_phase * s) * time).matrix();
    // The window keeps leakage of what else is there out of the fit.
    const Eigen::MatrixXd weighted = window.asDiagonal() * slopes;
    const Eigen::Matrix3d normal = slopes.transpose() * weighted;
    const Eigen::Vector3d right =
        weighted.transpose() *
        (samples.array() - mean - tone.in_phase * c - tone.quadrature * s).matrix();
    const Eigen::Vector3d change = normal.ldlt().solve(right);
    if (!change.allFinite()) break;
    // The frequency turns about the middle: the phase there stays.
    const double turn = change[2] / static_cast<double>(n);
    const Complex held = Complex(tone.in_phase + change[0], -(tone.quadrature + change[1])) *
                         std::polar(1.0, -turn * middle);
    tone = {tone.omega + turn, held.real(), -held.imag()};
    if (std::abs(turn) * static_cast<double>(n) < 1e-6) break;
  }
  return tone;
}

/// Mean over blocks of the squared amplitude that amplitude_at gives.
double power_at(const Eigen::Ref<const VectorXd>& samples, double omega) {
  const Index length = samples.size() / kBlocks;
  const VectorXd window = hann_window(length);
  double sum = 0;
  for (int k = 0; k < kBlocks; ++k)
    sum += std::norm(amplitude_at(samples.segment(k * length, length), window, omega));
  return sum / kBlocks;
}

/// How far a tone's frequency goes from `frequency_hz` between neighbouring half blocks, and two
/// lines of a block.
double wander_hz(const Eigen::Ref<const VectorXd>& samples, double rate_hz, double frequency_hz) {
  const Index length = samples.size() / kBlocks, step = length / 2;
  const VectorXd window = hann_window(length);
  const double omega = kTwoPi * frequency_hz / rate_hz;
  double farthest = 0;
  Complex before;
  for (Index first = 0; first + length <= samples.size(); first += step) {
    const Complex z = amplitude_at(samples.segment(first, length), window, omega) *
                      std::polar(1.0, -omega * static_cast<double>(first));
    if (first > 0) farthest = std::max(farthest, std::abs(std::arg(z * std::conj(before))));
    before = z;
  }
  return farthest * rate_hz / (kTwoPi * static_cast<double>(step)) +
         tone_resolution_hz(static_cast<double>(samples.size()), rate_hz);
}

/// Lines that stand out of the median of their neighbours, strongest first, Hz.
std::vector<double> outstanding_lines(const Eigen::Ref<const VectorXd>& samples, double rate_hz,
                                      double low_hz, double high_hz) {
  const Index n = good_fft_length_below(samples.size());
  RealFft fft(n);
  fft.time() = (samples.head(n).array() - samples.head(n).mean()) * hann_window(n).array();
  fft.forward();
  const VectorXd power = fft.spectrum().cwiseAbs2();
  const double line = rate_hz / static_cast<double>(n);
  constexpr Index kReach = 24, kLobe = 3;
  const double limit = std::log(1e3 * static_cast<double>(power.size())) / std::log(2.0);
  std::vector<std::pair<double, double>> found;
  std::vector<double> near;
  for (Index k = kLobe; k + kLobe < power.size(); ++k) {
    const double f = line * static_cast<double>(k);
    if (f < low_hz || f > high_hz || power[k] < power[k - 1] || power[k] < power[k + 1]) continue;
    near.clear();
    for (Index j = std::max<Index>(1, k - kReach); j < std::min(power.size(), k + kReach + 1);
         ++j) {
      if (std::abs(j - k) > kLobe) near.push_back(power[j]);
    }
    std::nth_element(near.begin(), near.begin() + static_cast<Index>(near.size() / 2), near.end());
    if (!(power[k] > limit * near[near.size() / 2])) continue;
    // The top of a Hann window's lobe from three amplitudes.
    const double a = std::sqrt(power[k - 1]), b = std::sqrt(power[k]), c = std::sqrt(power[k + 1]);
    const double shift = 2 * (c - a) / (a + 2 * b + c);
    found.emplace_back(-power[k], f + line * std::clamp(shift, -0.5, 0.5));
  }
  std::sort(found.begin(), found.end());
  if (found.size() > kMostLines) found.resize(kMostLines);
  std::vector<double> frequencies;
  frequencies.reserve(found.size());
  for (const auto& [minus_power, frequency] : found) frequencies.push_back(frequency);
  return frequencies;
}

}  // namespace

LineNature nature_of_line(const Eigen::Ref<const VectorXd>& samples, double rate_hz,
                          double frequency_hz, SteadyTone& measures) {
  const Index length = samples.size() / kBlocks;
  const double duration = static_cast<double>(samples.size()) / rate_hz;
  measures = {frequency_hz, 0, 0, 0};
  if (frequency_hz * duration < kLeastPeriods * kBlocks) return LineNature::varies;
  const VectorXd window = hann_window(length);
  // Line spacing of a block, rad a sample.
  const double line = kTwoPi / static_cast<double>(length);
  const double omega = kTwoPi * frequency_hz / rate_hz;
  constexpr std::array<double, 6> kBeside = {-4.5, -3.5, -2.5, 2.5, 3.5, 4.5};  // beyond the lobe
  std::array<double, kBeside.size()> beside{};
  std::array<double, kBlocks> power{};
  for (int k = 0; k < kBlocks; ++k) {
    const auto block = samples.segment(k * length, length);
    power[static_cast<std::size_t>(k)] = std::norm(amplitude_at(block, window, omega));
    for (std::size_t j = 0; j < kBeside.size(); ++j) {
      const double there = omega + kBeside[j] * line;
      if (there > 0 && there < kTwoPi / 2)
        beside[j] += std::norm(amplitude_at(block, window, there)) / kBlocks;
    }
  }
  std::sort(beside.begin(), beside.end());
  const double noise = (beside[2] + beside[3]) / 2;
  double mean = 0, squares = 0;
  for (const double p : power) mean += p / kBlocks;
  for (const double p : power) squares += (p - mean) * (p - mean) / (kBlocks - 1);
  const double own = mean - noise;
  if (!(own > noise)) return LineNature::varies;
  measures.amplitude = 2 * std::sqrt(own);
  measures.variation = squares / (own * own);
  measures.limit = variation_limit(2 * kLeastDamping * frequency_hz, duration);
  if (measures.variation < measures.limit) return LineNature::steady;
  const double of_tone = (2 * own * noise + noise * noise) / (own * own);
  return measures.variation < kToneScatter * of_tone ? LineNature::undecided : LineNature::varies;
}

TonesRemoved remove_steady_tones(const Eigen::Ref<const VectorXd>& samples, double rate_hz,
                                 double low_hz, double high_hz) {
  TonesRemoved removed{{}, samples};
  for (const double frequency : outstanding_lines(samples, rate_hz, low_hz, high_hz)) {
    SteadyTone tone;
    if (nature_of_line(removed.samples, rate_hz, frequency, tone) != LineNature::steady) continue;
    const auto fit = fitted_sinusoid(removed.samples, kTwoPi * frequency / rate_hz);
    tone.frequency_hz = fit.omega * rate_hz / kTwoPi;
    // Not where the fit has left the line.
    const double line = rate_hz / static_cast<double>(samples.size());
    if (!(std::abs(tone.frequency_hz - frequency) < 2 * line)) continue;
    removed.samples.array() -=
        (Complex(fit.in_phase, -fit.quadrature) * powers(Complex(0, fit.omega), samples.size()))
            .real();
    const double left = power_at(removed.samples, fit.omega);
    if (left > kWandering * tone.amplitude * tone.amplitude / 4)
      tone.reach_hz = wander_hz(samples, rate_hz, tone.frequency_hz);
    removed.tones.push_back(tone);
  }
  return removed;
}

double tone_resolution_hz(double samples, double sample_rate_hz) {
  return 2 * kBlocks * sample_rate_hz / samples;
}

}  // namespace rigfit::signal
