#include "tests/reference/struck_structure.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <random>

namespace rigfit::testing {
namespace {
using Eigen::Index;
using Eigen::VectorXd;
constexpr double kPi = std::numbers::pi;
constexpr int kFine = 8;

/// Every kFine-th of the fine samples, after a low-pass at 0.35 of the sampling rate.
VectorXd sampled(const VectorXd& fine) {
  constexpr Index kHalf = 16 * kFine;
  VectorXd taps(2 * kHalf + 1);
  for (Index k = -kHalf; k <= kHalf; ++k) {
    const double x = static_cast<double>(k) * 0.7 / kFine, w = kPi * static_cast<double>(k) / kHalf;
    taps[k + kHalf] = (k == 0 ? 1 : std::sin(kPi * x) / (kPi * x)) *
                      (0.42 + 0.5 * std::cos(w) + 0.08 * std::cos(2 * w));
  }
  taps /= taps.sum();
  VectorXd result((fine.size() - 1) / kFine);
  for (Index n = 0; n < result.size(); ++n) {
    const Index first = std::max<Index>(0, kFine * n - kHalf);
    const Index last = std::min(fine.size(), kFine * n + kHalf + 1);
    result[n] = taps.segment(first - kFine * n + kHalf, last - first)
                    .dot(fine.segment(first, last - first));
  }
  return result;
}

/// Acceleration of one mode under a force linear between steps of `h`, at every step.
VectorXd modal_acceleration(double omega, double zeta, const VectorXd& force, double h) {
  const double wd = omega * std::sqrt(1 - zeta * zeta), a = zeta * omega;
  const double e = std::exp(-a * h), s = std::sin(wd * h), c = std::cos(wd * h);
  const double k = omega * omega;
  // q(t) = particular (linear in t) + e^-at (A cos + B sin).
  double q = 0, v = 0;
  VectorXd result = VectorXd::Zero(force.size());
  for (Index n = 0; n + 1 < force.size(); ++n) {
    result[n] = force[n] - 2 * a * v - k * q;
    const double f0 = force[n], slope = (force[n + 1] - f0) / h;
    const double p1 = slope / k, p0 = (f0 - 2 * a * p1) / k;
    const double A = q - p0, B = (v - p1 + a * A) / wd;
    const double next = p0 + p1 * h + e * (A * c + B * s);
    v = p1 + e * ((B * wd - a * A) * c - (A * wd + a * B) * s);
    q = next;
  }
  return result;
}

VectorXd coloured(Index n, double std, double colour, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  VectorXd x(n);
  double value = normal(random);
  const double fresh = std::sqrt(1 - colour * colour);
  for (double& sample : x) {
    sample = std * value;
    value = colour * value + fresh * normal(random);
  }
  return x;
}

void quantise(VectorXd& x, double bits) {
  if (!(bits > 0)) return;
  const double step = 2 * x.cwiseAbs().maxCoeff() / std::pow(2.0, bits);
  if (step > 0) x = (x.array() / step).round() * step;
}

}  // namespace

StruckStructure::StruckStructure(Index responses)
    : frequency_hz(4), damping_ratio(4), shapes(responses, 4) {
  frequency_hz << 9.3, 21.7, 38.1, 55.2;
  damping_ratio << 0.012, 0.008, 0.01, 0.006;
  for (Index j = 0; j < responses; ++j) {
    const double x = 0.17 + 0.71 * static_cast<double>(j) / static_cast<double>(responses);
    for (Index r = 0; r < 4; ++r) shapes(j, r) = std::sin(static_cast<double>(r + 1) * kPi * x);
  }
}

std::vector<signal::Recording> struck_recordings(const StruckStructure& structure,
                                                 const StrikeOptions& options) {
  std::mt19937_64 random(options.seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal;
  constexpr double kPeak = 100;
  const auto n = static_cast<Index>((options.before_s + options.after_s) * options.sample_rate_hz);
  const double h = 1 / (kFine * options.sample_rate_hz);
  std::vector<signal::Recording> recordings;
  for (int i = 0; i < options.hits; ++i) {
    const double size = 1 + options.size_scatter * uniform(random);
    const double duration = options.pulse_s * (1 + 0.1 * uniform(random));
    const double start = options.before_s + 0.1 * uniform(random) * options.before_s;
    const double factor = 1 + options.frequency_scatter * normal(random);
    const double second = start + 0.035 + 0.015 * uniform(random);
    const auto pulse = [&](double t, double peak) {
      return t > 0 && t < duration ? peak * std::sin(kPi * t / duration) : 0;
    };
    VectorXd fine(kFine * n + 1);
    for (Index k = 0; k < fine.size(); ++k) {
      const double t = static_cast<double>(k) * h;
      fine[k] =
          pulse(t - start, kPeak * size) + pulse(t - second, kPeak * size * options.second_contact);
    }
    Eigen::MatrixXd responses = Eigen::MatrixXd::Zero(n, structure.shapes.rows());
    for (Index r = 0; r < structure.frequency_hz.size(); ++r) {
      const VectorXd q = sampled(modal_acceleration(2 * kPi * structure.frequency_hz[r] * factor,
                                                    structure.damping_ratio[r], fine, h));
      responses += q * (structure.shapes.col(r) * structure.shapes(0, r)).transpose();
    }
    signal::Recording recording;
    recording.path = fmt::format("hit{}.csv", i + 1);
    recording.sample_rate_hz = options.sample_rate_hz;
    const auto add = [&](const std::string& name, const std::string& unit, VectorXd samples) {
      quantise(samples, options.converter_bits);
      signal::Channel channel;
      channel.name = name;
      channel.unit = unit;
      channel.samples = std::move(samples);
      recording.channels.push_back(std::move(channel));
    };
    add("force", "N",
        sampled(fine) +
            coloured(n, options.force_noise * kPeak, options.force_noise_colour, random));
    for (Index j = 0; j < responses.cols(); ++j) {
      const double rms = responses.col(j).norm() / std::sqrt(static_cast<double>(n)) / size;
      add(fmt::format("a{}", j + 1), "m/s^2",
          responses.col(j) + coloured(n, options.response_noise * rms, 0, random));
    }
    recordings.push_back(std::move(recording));
  }
  return recordings;
}

}  // namespace rigfit::testing
