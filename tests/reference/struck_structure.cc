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

/// Modal accelerations (steps x modes) under a force at a place with mode shapes `struck`, and a
/// spring of `cubic` N/m^3 at response 0.
Eigen::MatrixXd modal_accelerations(const StruckStructure& structure, double factor,
                                    const VectorXd& struck, double cubic, const VectorXd& force,
                                    double h) {
  const Index modes = structure.frequency_hz.size();
  std::vector<Oscillator> all;
  all.reserve(static_cast<std::size_t>(modes));
  for (Index r = 0; r < modes; ++r) {
    all.emplace_back(2 * kPi * structure.frequency_hz[r] * factor, structure.damping_ratio[r], h);
  }
  const VectorXd shape = structure.shapes.row(0).transpose();
  const auto spring = [&] {
    double x = 0;
    for (Index r = 0; r < modes; ++r) x += shape[r] * all[static_cast<std::size_t>(r)].q;
    return -cubic * x * x * x;
  };
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(force.size(), modes);
  for (Index n = 0; n + 1 < force.size(); ++n) {
    const double before = cubic != 0 ? spring() : 0;
    for (Index r = 0; r < modes; ++r) {
      Oscillator& mode = all[static_cast<std::size_t>(r)];
      result(n, r) = mode.acceleration(struck[r] * force[n] + shape[r] * before);
      mode.v += 0.5 * h * shape[r] * before;
      mode.step(struck[r] * force[n], struck[r] * force[n + 1]);
    }
    if (cubic == 0) continue;
    const double after = spring();
    for (Index r = 0; r < modes; ++r) {
      all[static_cast<std::size_t>(r)].v += 0.5 * h * shape[r] * after;
    }
  }
  return result;
}

/// N/m^3 that shift the first mode by `bandwidths` after a hit of impulse `impulse`: backbone curve
/// w^2 = w0^2 + 3/4 k phi^4 A^2, A = phi impulse / w0.
double cubic_stiffness(const StruckStructure& structure, double bandwidths, double impulse) {
  const double w = 2 * kPi * structure.frequency_hz[0], phi = structure.shapes(0, 0);
  const double shift = 2 * structure.damping_ratio[0] * bandwidths;
  return shift * w * w * 8 / 3 / (std::pow(phi, 4) * std::pow(phi * impulse / w, 2));
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
  const double cubic = cubic_stiffness(structure, options.cubic, 2 / kPi * kPeak * options.pulse_s);
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
    VectorXd struck = structure.shapes.row(0).transpose();
    if (options.off_axis > 0 || options.off_place > 0) {
      struck = struck_shapes(structure, kStruckAt + options.off_place * normal(random),
                             std::sin(options.off_axis * normal(random)));
    }
    const Eigen::MatrixXd q = modal_accelerations(structure, factor, struck, cubic, fine, h);
    Eigen::MatrixXd responses = Eigen::MatrixXd::Zero(n, structure.shapes.rows());
    for (Index r = 0; r < q.cols(); ++r) {
      responses += sampled(q.col(r)) * structure.shapes.col(r).transpose();
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
