#include "tests/reference/ten_mode_truth.h"
#include "tests/normal.h"

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <string>

namespace rigfit::testing {
namespace {
using Complex = std::complex<double>;
using Eigen::Index;
constexpr double kPi = std::numbers::pi;

std::string response_name(Index j) {
  std::string name = "a";
  name += std::to_string(j + 1);
  return name;
}

/// Poles and residues of a unit-gain Butterworth low-pass.
struct Filter {
  Eigen::VectorXcd poles, residues;
  Complex operator()(Complex s) const { return (residues.array() / (s - poles.array())).sum(); }
};

Filter butterworth(double cutoff_hz, int order) {
  Filter filter{Eigen::VectorXcd(order), Eigen::VectorXcd(order)};
  const double w = 2 * kPi * cutoff_hz;
  for (int k = 0; k < order; ++k) {
    filter.poles[k] = std::polar(w, kPi * (2.0 * k + order + 1) / (2 * order));
  }
  for (int k = 0; k < order; ++k) {
    Complex product = 1;
    for (int m = 0; m < order; ++m) {
      product *= m == k ? Complex(w) : w / (filter.poles[k] - filter.poles[m]);
    }
    filter.residues[k] = product;
  }
  return filter;
}

/// z(t) = integral of exp(p (t - u)) F(u) du over the half sine, for one pole, at t >= 0 samples
/// added to `z`.
void add_half_sine(Complex p, const HammerHit& hit, double rate, Eigen::Ref<Eigen::VectorXcd> z) {
  const double omega = kPi / hit.duration_s;
  const Complex scale = hit.peak / (p * p + omega * omega);
  const Complex at_end = scale * omega * (1.0 + std::exp(p * hit.duration_s));
  Index n = static_cast<Index>(std::ceil(hit.time_s * rate));
  for (; n < z.size(); ++n) {
    const double t = static_cast<double>(n) / rate - hit.time_s;
    if (t > hit.duration_s) break;
    z[n] +=
        scale * (omega * std::exp(p * t) - omega * std::cos(omega * t) - p * std::sin(omega * t));
  }
  if (n >= z.size()) return;
  Complex value =
      at_end * std::exp(p * (static_cast<double>(n) / rate - hit.time_s - hit.duration_s));
  const Complex step = std::exp(p / rate);
  for (; n < z.size() && std::norm(value) > 1e-40 * std::norm(at_end); ++n, value *= step) {
    z[n] += value;
  }
}

}  // namespace

Eigen::VectorXcd TenModeTruth::poles() const {
  const Eigen::ArrayXd w = 2 * kPi * frequency_hz.array(), zeta = damping_ratio.array();
  Eigen::VectorXcd p(w.size());
  p.real() = -zeta * w;
  p.imag() = w * (1 - zeta.square()).sqrt();
  return p;
}

Eigen::MatrixXcd TenModeTruth::residues() const {
  const Eigen::VectorXcd p = poles();
  Eigen::MatrixXcd result(shapes.rows(), shapes.cols());
  for (Index r = 0; r < p.size(); ++r) {
    result.col(r) = shapes.col(r) * (shapes(driving_point, r) / Complex(0, 2 * p[r].imag()));
  }
  return result;
}

Eigen::MatrixXcd TenModeTruth::accelerance(const Eigen::VectorXd& lines_hz,
                                           double decay_rate_1_s) const {
  const Eigen::VectorXcd p = poles();
  const Eigen::MatrixXcd psi = residues();
  Eigen::MatrixXcd H(lines_hz.size(), shapes.rows());
  for (Index k = 0; k < lines_hz.size(); ++k) {
    const Complex s(decay_rate_1_s, 2 * kPi * lines_hz[k]);
    const Eigen::RowVectorXcd up = (s - p.array()).inverse().matrix().transpose();
    const Eigen::RowVectorXcd down = (s - p.array().conjugate()).inverse().matrix().transpose();
    H.row(k) = s * s * (up * psi.transpose() + down * psi.adjoint());
  }
  return H;
}

signal::FrfSet TenModeTruth::frfs(const Eigen::VectorXd& lines_hz, double decay_rate_1_s) const {
  signal::FrfSet set{.frequency_hz = lines_hz};
  for (Index j = 0; j < shapes.rows(); ++j) {
    set.responses.push_back({response_name(j), static_cast<int>(j + 1), 3});
  }
  set.inputs.push_back({"force", static_cast<int>(driving_point + 1), 3});
  set.H = accelerance(lines_hz, decay_rate_1_s);
  set.form = signal::FrfForm::accelerance;
  set.unit = "(m/s^2)/N";
  set.exponential_decay_rate_1_s = decay_rate_1_s;
  return set;
}

TenModeTruth ten_mode_truth(Index responses) {
  TenModeTruth truth;
  truth.frequency_hz.resize(10);
  truth.damping_ratio.resize(10);
  truth.frequency_hz << 25, 68, 132, 221, 312, 318, 437, 590, 905, 1240;
  truth.damping_ratio << 0.01, 0.008, 0.006, 0.005, 0.003, 0.0035, 0.004, 0.003, 0.0025, 0.0025;
  truth.shapes.resize(responses, 10);
  constexpr double kMass = 8;  // kg, of a uniform member
  for (Index j = 0; j < responses; ++j) {
    const double x = (static_cast<double>(j) + 0.6) / (static_cast<double>(responses) + 0.7);
    for (Index r = 0; r < 10; ++r) {
      truth.shapes(j, r) = std::sqrt(2 / kMass) * std::sin(static_cast<double>(r + 1) * kPi * x);
    }
  }
  // The response where the weakest of the ten modes is strongest.
  truth.shapes.array().abs().rowwise().minCoeff().maxCoeff(&truth.driving_point);
  return truth;
}

std::vector<HammerHit> hammer_hits(const ImpactRecordOptions& options) {
  std::mt19937_64 random(options.seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<HammerHit> hits;
  double time = 0.1;
  for (int i = 0; i < options.hits; ++i) {
    HammerHit hit{.time_s = time + 0.3 * uniform(random),
                  .peak = 70 + 60 * uniform(random),
                  .duration_s = 0.55e-3 + 0.1e-3 * uniform(random)};
    hits.push_back(hit);
    time = hit.time_s + static_cast<double>(options.block_samples) / options.sample_rate_hz;
  }
  return hits;
}

signal::Recording impact_recording(const TenModeTruth& truth, const std::vector<HammerHit>& hits,
                                   const ImpactRecordOptions& options,
                                   std::optional<double> duration_s) {
  const double rate = options.sample_rate_hz;
  double end = 0.1;
  for (const HammerHit& hit : hits) end = std::max(end, hit.time_s);
  const double duration =
      duration_s.value_or(end + static_cast<double>(options.block_samples) / rate);
  const auto samples = static_cast<Index>(std::ceil(duration * rate));
  const Filter filter = butterworth(options.filter_hz, options.filter_order);
  const Eigen::VectorXcd modal = truth.poles();
  const Index outputs = truth.shapes.rows();

  // y = sum over poles of 2 Re(residue z) for the modal ones, Re(residue z) for the filter's own
  // (which come in conjugate pairs, both listed).
  Eigen::MatrixXd channels = Eigen::MatrixXd::Zero(samples, outputs + 1);
  Eigen::VectorXcd z(samples);
  const auto add_pole = [&](Complex p, const Eigen::VectorXcd& residues) {
    z.setZero();
    for (const HammerHit& hit : hits) add_half_sine(p, hit, rate, z);
    for (Index c = 0; c < residues.size(); ++c) {
      channels.col(c) += z.real() * residues[c].real() - z.imag() * residues[c].imag();
    }
  };
  const Eigen::MatrixXcd psi = truth.residues();
  for (Index r = 0; r < modal.size(); ++r) {
    Eigen::VectorXcd residue = Eigen::VectorXcd::Zero(outputs + 1);
    residue.tail(outputs) = 2.0 * modal[r] * modal[r] * filter(modal[r]) * psi.col(r);
    add_pole(modal[r], residue);
  }
  for (Index k = 0; k < filter.poles.size(); ++k) {
    const Complex s = filter.poles[k];
    Eigen::VectorXcd residue(outputs + 1);
    residue[0] = filter.residues[k];
    const Eigen::VectorXcd alpha =
        psi * (s - modal.array()).inverse().matrix() +
        psi.conjugate() * (s - modal.array().conjugate()).inverse().matrix();
    residue.tail(outputs) = filter.residues[k] * s * s * alpha;
    add_pole(s, residue);
  }
  if (options.ringing != 0) {
    for (const HammerHit& hit : hits) {
      const double w = 2 * kPi * options.ringing_hz, start = hit.time_s + hit.duration_s / 2;
      for (auto n = static_cast<Index>(std::ceil(start * rate)); n < samples; ++n) {
        const double t = static_cast<double>(n) / rate - start;
        const double decay = std::exp(-options.ringing_damping * w * t);
        if (decay < 1e-12) break;
        channels(n, 0) += options.ringing * hit.peak * decay * std::sin(w * t);
      }
    }
  }

  rigfit::testing::Normal normal(options.seed ^ 0x9e3779b97f4a7c15ULL);
  for (Index c = 0; c < channels.cols(); ++c) {
    auto x = channels.col(c);
    const double rms = std::sqrt(x.squaredNorm() / static_cast<double>(samples));
    const double sigma = options.noise * (options.noise_of_peak ? x.cwiseAbs().maxCoeff() : rms);
    if (sigma > 0) {
      for (Index n = 0; n < samples; ++n) x[n] += sigma * normal();
    }
    x.array() += options.offset * rms;
  }
  channels.col(0) *= options.force_sign;

  signal::Recording recording{.path = "ten_modes", .format = "csv", .sample_rate_hz = rate};
  for (Index c = 0; c < channels.cols(); ++c) {
    signal::Channel channel{.name = c == 0 ? "force" : response_name(c - 1)};
    channel.unit = channel.source_unit = c == 0 ? "N" : "m/s^2";
    channel.quantity = c == 0 ? signal::Quantity::force : signal::Quantity::acceleration;
    channel.samples = channels.col(c);
    recording.channels.push_back(std::move(channel));
  }
  return recording;
}

}  // namespace rigfit::testing
