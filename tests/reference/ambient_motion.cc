#include "tests/reference/ambient_motion.h"
#include "tests/normal.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <complex>
#include <numbers>

namespace rigfit::reference {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

namespace {

/// Covariance of (Re u, Im u) of all modes that noise of covariance C leaves within `step`; that
/// of the stationary motion for a negative step.
MatrixXd covariance(const VectorXcd& poles, const MatrixXd& C, double step) {
  const Index n = poles.size();
  MatrixXd Q(2 * n, 2 * n);
  for (Index r = 0; r < n; ++r) {
    for (Index s = 0; s < n; ++s) {
      const auto integral = [&](Complex sum) {
        return C(r, s) * (step < 0 ? -1.0 / sum : (std::exp(sum * step) - 1.0) / sum);
      };
      const Complex a = integral(poles[r] + std::conj(poles[s]));  // E u_r conj(u_s)
      const Complex b = integral(poles[r] + poles[s]);             // E u_r u_s
      Q(2 * r, 2 * s) = 0.5 * (a + b).real();
      Q(2 * r + 1, 2 * s + 1) = 0.5 * (a - b).real();
      Q(2 * r + 1, 2 * s) = 0.5 * (a + b).imag();
      Q(2 * r, 2 * s + 1) = 0.5 * (b - a).imag();
    }
  }
  return Q;
}

}  // namespace

AmbientStructure storeys(Index n, double first_hz, double damping_ratio) {
  AmbientStructure chain{VectorXd(n), VectorXd::Constant(n, damping_ratio), MatrixXd(n, n),
                         MatrixXd::Identity(n, n)};
  const double first = std::numbers::pi / static_cast<double>(2 * n + 1);
  for (Index r = 0; r < n; ++r) {
    const double angle = static_cast<double>(2 * r + 1) * first;
    chain.frequency_hz[r] = first_hz * std::sin(angle / 2) / std::sin(first / 2);
    for (Index i = 0; i < n; ++i) chain.shapes(i, r) = std::sin(static_cast<double>(i + 1) * angle);
  }
  return chain;
}

AmbientStructure five_storeys(double damping_ratio) { return storeys(5, 0.89, damping_ratio); }

AmbientStructure close_pair(double apart, Index channels) {
  AmbientStructure pair{VectorXd(2), VectorXd::Constant(2, 0.01), MatrixXd(channels, 2),
                        MatrixXd::Identity(2, 2)};
  pair.frequency_hz << 2, 2 * (1 + apart);
  for (Index i = 0; i < channels; ++i) {
    const double x = (static_cast<double>(i) + 0.5) / static_cast<double>(channels);
    pair.shapes(i, 0) = std::sin(std::numbers::pi * x);
    pair.shapes(i, 1) = std::sin(2 * std::numbers::pi * x);
  }
  return pair;
}

signal::Recording recorded(const AmbientStructure& structure, const AmbientMotion& motion) {
  const Index n = structure.frequency_hz.size(), channels = structure.shapes.rows();
  const auto samples = static_cast<Index>(motion.duration_s * motion.rate_hz);
  const double dt = 1 / motion.rate_hz;
  VectorXcd poles(n), turn(n), u(n);
  for (Index r = 0; r < n; ++r) {
    const double omega = 2 * std::numbers::pi * structure.frequency_hz[r],
                 zeta = structure.damping_ratio[r];
    poles[r] = omega * Complex(-zeta, std::sqrt(1 - zeta * zeta));
    turn[r] = std::exp(poles[r] * dt);
  }
  rigfit::testing::Normal normal(motion.seed);
  const auto draw = [&](const MatrixXd& factor) {
    return VectorXd(factor * VectorXd::NullaryExpr(2 * n, [&] { return normal(); }));
  };
  const MatrixXd start = covariance(poles, structure.forces, -1).llt().matrixL();
  const MatrixXd step = covariance(poles, structure.forces, dt).llt().matrixL();
  const auto add = [&](const VectorXd& e) {
    for (Index r = 0; r < n; ++r) u[r] += Complex(e[2 * r], e[2 * r + 1]);
  };
  const auto velocity = [&] {
    VectorXd v(n);
    for (Index r = 0; r < n; ++r)
      v[r] = u[r].real() + poles[r].real() / poles[r].imag() * u[r].imag();
    return v;
  };
  u.setZero();
  add(draw(start));
  MatrixXd motions(samples, n);
  VectorXd before = velocity();
  for (Index k = 0; k < samples; ++k) {
    u = u.cwiseProduct(turn).eval();
    const double a = motion.amplitude ? motion.amplitude(static_cast<double>(k) * dt) : 1;
    add(a * draw(step));
    const VectorXd v = velocity();
    motions.row(k) = (v - before).transpose() / dt;
    before = v;
  }
  signal::Recording recording{.path = "ambient.csv", .sample_rate_hz = motion.rate_hz};
  for (Index c = 0; c < channels; ++c) {
    signal::Channel channel{.name = "c" + std::to_string(c + 1),
                            .unit = "m/s^2",
                            .quantity = signal::Quantity::acceleration,
                            .samples = motions * structure.shapes.row(c).transpose()};
    const double noise =
        motion.noise * channel.samples.norm() / std::sqrt(static_cast<double>(samples));
    for (double& x : channel.samples) x += noise * normal();
    recording.channels.push_back(std::move(channel));
  }
  return recording;
}

}  // namespace rigfit::reference
