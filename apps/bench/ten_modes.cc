#include "apps/bench/ten_modes.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <string>

namespace rigfit::apps {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
constexpr double kPi = std::numbers::pi;

}  // namespace

TenModes::TenModes(Index responses) {
  frequency_hz.resize(10);
  damping_ratio.resize(10);
  frequency_hz << 25, 68, 132, 221, 312, 318, 437, 590, 905, 1240;
  damping_ratio << 0.01, 0.008, 0.006, 0.005, 0.003, 0.0035, 0.004, 0.003, 0.0025, 0.0025;
  shapes.resize(responses, 10);
  // Half waves along a uniform member of 8 kg; struck where no mode has a node.
  for (Index j = 0; j < responses; ++j) {
    const double x = j == 0 ? 0.045 : double(j) / double(responses);
    for (Index r = 0; r < 10; ++r) shapes(j, r) = 0.5 * std::sin(double(r + 1) * kPi * x);
  }
}

Eigen::VectorXcd TenModes::poles() const {
  const Eigen::ArrayXd w = 2 * kPi * frequency_hz.array(), zeta = damping_ratio.array();
  Eigen::VectorXcd p(w.size());
  p.real() = -zeta * w;
  p.imag() = w * (1 - zeta.square()).sqrt();
  return p;
}

signal::FrfSet TenModes::frfs(const Eigen::VectorXd& lines_hz, double noise,
                              std::uint64_t seed) const {
  signal::FrfSet set;
  set.frequency_hz = lines_hz;
  set.form = signal::FrfForm::accelerance;
  set.unit = signal::unit_of(set.form);
  for (Index j = 0; j < shapes.rows(); ++j) {
    set.responses.push_back({std::string("a") + std::to_string(j + 1), int(j + 1), 3});
  }
  set.inputs.push_back({"force", 1, 3});
  set.H.setZero(lines_hz.size(), shapes.rows());
  for (Index r = 0; r < frequency_hz.size(); ++r) {
    const double wr = 2 * kPi * frequency_hz[r];
    for (Index k = 0; k < lines_hz.size(); ++k) {
      const double w = 2 * kPi * lines_hz[k];
      const Complex gain =
          -w * w * shapes(0, r) / Complex(wr * wr - w * w, 2 * damping_ratio[r] * wr * w);
      for (Index j = 0; j < shapes.rows(); ++j) set.H(k, j) += gain * shapes(j, r);
    }
  }
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double scale = noise * set.H.norm() / std::sqrt(2 * static_cast<double>(set.H.size()));
  for (Complex& h : set.H.reshaped()) {
    const double re = normal(random), im = normal(random);
    h += scale * Complex(re, im);
  }
  return set;
}

SampledStructure::SampledStructure(const TenModes& modes, double sample_rate_hz)
    : rate_hz(sample_rate_hz) {
  const Eigen::VectorXcd p = modes.poles();
  z = (p / rate_hz).array().exp();
  residues.resize(modes.shapes.rows(), p.size());
  for (Index r = 0; r < p.size(); ++r) {
    // Of accelerance: p^2 phi phi' / (2 i w_d).
    residues.col(r) =
        modes.shapes.col(r) * (p[r] * p[r] * modes.shapes(0, r) / Complex(0, 2 * p[r].imag()));
  }
}

Eigen::MatrixXcd SampledStructure::frfs(const Eigen::VectorXd& lines_hz,
                                        double decay_rate_1_s) const {
  Eigen::MatrixXcd H = Eigen::MatrixXcd::Zero(lines_hz.size(), residues.rows());
  for (Index k = 0; k < lines_hz.size(); ++k) {
    const Complex back = std::exp(-Complex(decay_rate_1_s, 2 * kPi * lines_hz[k]) / rate_hz);
    for (Index r = 0; r < z.size(); ++r) {
      const Complex up = 1.0 / (1.0 - z[r] * back), down = 1.0 / (1.0 - std::conj(z[r]) * back);
      for (Index j = 0; j < residues.rows(); ++j) {
        H(k, j) += residues(j, r) * up + std::conj(residues(j, r)) * down;
      }
    }
  }
  return H;
}

Eigen::MatrixXd SampledStructure::hit(Index samples, Index start, int contact, double peak,
                                      double noise, std::uint64_t seed) const {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(samples, 1 + residues.rows());
  for (int i = 0; i < contact && start + i < samples; ++i) {
    out(start + i, 0) = peak * std::sin(kPi * (i + 0.5) / contact);
  }
  for (Index r = 0; r < z.size(); ++r) {
    Complex x = 0;
    for (Index n = start; n < samples; ++n) {
      x = z[r] * x + out(n, 0);
      for (Index j = 0; j < residues.rows(); ++j) {
        out(n, 1 + j) += 2 * (residues(j, r).real() * x.real() - residues(j, r).imag() * x.imag());
      }
    }
  }
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (Index c = 0; c < out.cols(); ++c) {
    const double sigma = noise * out.col(c).norm() / std::sqrt(static_cast<double>(samples));
    if (sigma > 0) {
      for (double& v : out.col(c)) v += sigma * normal(random);
    }
  }
  return out;
}

}  // namespace rigfit::apps
