#include "tests/reference/struck_structure.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace rigfit::testing {
namespace {
using Eigen::Index;
using Eigen::VectorXd;
constexpr double kPi = std::numbers::pi;
constexpr int kFine = 8;
constexpr double kStruckAt = 0.17;  // place relative to the length

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

/// One mode over a step of `h` under a force that is linear in it.
class Oscillator {
 public:
  Oscillator(double omega, double zeta, double h)
      : a_(zeta * omega), k_(omega * omega), wd_(omega * std::sqrt(1 - zeta * zeta)), h_(h) {
    e_ = std::exp(-a_ * h), s_ = std::sin(wd_ * h), c_ = std::cos(wd_ * h);
  }

  double q = 0, v = 0;

  double acceleration(double force) const { return force - 2 * a_ * v - k_ * q; }

  void step(double f0, double f1) {
    // q(t) = particular (linear in t) + e^-at (A cos + B sin).
    const double slope = (f1 - f0) / h_;
    const double p1 = slope / k_, p0 = (f0 - 2 * a_ * p1) / k_;
    const double A = q - p0, B = (v - p1 + a_ * A) / wd_;
    q = p0 + p1 * h_ + e_ * (A * c_ + B * s_);
    v = p1 + e_ * ((B * wd_ - a_ * A) * c_ - (A * wd_ + a_ * B) * s_);
  }

 private:
  double a_, k_, wd_, h_, e_ = 0, s_ = 0, c_ = 0;
};

/// Modal accelerations (steps x modes) under a force at a place with mode shapes `struck`.
Eigen::MatrixXd modal_accelerations(const StruckStructure& structure, double factor,
                                    const VectorXd& struck, const VectorXd& force, double h) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(force.size(), structure.frequency_hz.size());
  for (Index r = 0; r < result.cols(); ++r) {
    Oscillator mode(2 * kPi * structure.frequency_hz[r] * factor, structure.damping_ratio[r], h);
    for (Index n = 0; n + 1 < force.size(); ++n) {
      result(n, r) = mode.acceleration(struck[r] * force[n]);
      mode.step(struck[r] * force[n], struck[r] * force[n + 1]);
    }
  }
  return result;
}

/// Mode shapes along the force of a hit off its place and axis.
VectorXd struck_shapes(const StruckStructure& structure, double place, double across) {
  VectorXd shapes(structure.frequency_hz.size());
  for (Index r = 0; r < shapes.size(); ++r) {
    const double number = static_cast<double>(r + 1) * kPi;
    shapes[r] = std::sqrt(1 - across * across) * std::sin(number * place) +
                across * 0.7 * std::cos(number * place);
  }
  return shapes;
}

VectorXd noise(Index n, double std, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  VectorXd x(n);
  for (double& sample : x) sample = std * normal(random);
  normal(random);  // keeps the numbers that follow
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
    const double x = kStruckAt + 0.71 * static_cast<double>(j) / static_cast<double>(responses);
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
    const double size = 1 + 0.3 * uniform(random);
    const double duration = options.pulse_s * (1 + 0.1 * uniform(random));
    const double start = options.before_s + 0.1 * uniform(random) * options.before_s;
    const double factor = 1 + options.frequency_scatter * normal(random);
    uniform(random);  // keeps the numbers that follow
    VectorXd fine(kFine * n + 1);
    for (Index k = 0; k < fine.size(); ++k) {
      const double t = static_cast<double>(k) * h - start;
      fine[k] = t > 0 && t < duration ? kPeak * size * std::sin(kPi * t / duration) : 0;
    }
    VectorXd struck = structure.shapes.row(0).transpose();
    if (options.off_axis > 0 || options.off_place > 0) {
      struck = struck_shapes(structure, kStruckAt + options.off_place * normal(random),
                             std::sin(options.off_axis * normal(random)));
    }
    const Eigen::MatrixXd q = modal_accelerations(structure, factor, struck, fine, h);
    Eigen::MatrixXd responses = Eigen::MatrixXd::Zero(n, structure.shapes.rows());
    for (Index r = 0; r < q.cols(); ++r) {
      responses += sampled(q.col(r)) * structure.shapes.col(r).transpose();
    }
    signal::Recording recording{.path = fmt::format("hit{}.csv", i + 1),
                                .sample_rate_hz = options.sample_rate_hz};
    const auto add = [&](const std::string& name, const std::string& unit, VectorXd samples) {
      quantise(samples, options.converter_bits);
      recording.channels.push_back({.name = name, .unit = unit, .samples = std::move(samples)});
    };
    add("force", "N", sampled(fine) + noise(n, options.force_noise * kPeak, random));
    for (Index j = 0; j < responses.cols(); ++j) {
      const double rms = responses.col(j).norm() / std::sqrt(static_cast<double>(n)) / size;
      add(fmt::format("a{}", j + 1), "m/s^2",
          responses.col(j) + noise(n, options.response_noise * rms, random));
    }
    recordings.push_back(std::move(recording));
  }
  return recordings;
}

}  // namespace rigfit::testing
