#include "tests/reference/axial_rig.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "ident/campaign/single_tests/axial_campaign.h"

namespace rigfit::reference {

using Eigen::Index;

signal::Recording axial_rig_record(const AxialRig& rig, ident::Random& random) {
  constexpr Index kElements = 24;
  constexpr double kStiff = 1e12, kGravity = 9.80665;
  // Nodes of the cable, then the mass.
  const Index n = kElements + 2;
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n), M = Eigen::MatrixXd::Zero(n, n);
  const double h = rig.length_m / kElements, k = rig.EA_N / h;
  const auto spring = [&](Index i, Index j, double stiffness) {
    K(i, i) += stiffness, K(j, j) += stiffness, K(i, j) -= stiffness, K(j, i) -= stiffness;
  };
  for (Index e = 0; e < kElements; ++e) {
    spring(e, e + 1, k);
    const double m = rig.mass_per_length_kg_m * h / 6;
    M(e, e) += 2 * m, M(e + 1, e + 1) += 2 * m, M(e, e + 1) += m, M(e + 1, e) += m;
  }
  K(0, 0) += rig.frame_N_m > 0 ? rig.frame_N_m : kStiff;
  spring(n - 2, n - 1, rig.adapter_N_m > 0 ? rig.adapter_N_m : kStiff);
  M(n - 1, n - 1) += rig.mass_kg;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(K, M);

  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const double dt = 1 / rig.sample_rate_hz;
  const double tap = rig.before_s + dt * uniform(random);
  const double impulse = rig.tap_N_s * (1 + 0.2 * std::tanh(normal(random)));
  const double swing = std::sqrt(kGravity / rig.length_m), swing_phase = 2 * M_PI * uniform(random);
  const double hum = 2 * M_PI * (50 + 0.1 * (uniform(random) - 0.5));
  const double hum_phase = 2 * M_PI * uniform(random);
  const auto samples = static_cast<Index>((rig.before_s + rig.after_s) * rig.sample_rate_hz);
  Eigen::VectorXd tension(samples);
  for (Index i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) * dt, s = t - tap;
    const double envelope = rig.pendulum_rad * std::exp(-0.003 * swing * t);
    const double angle = envelope * std::cos(swing * t + swing_phase);
    const double rate = -envelope * swing * std::sin(swing * t + swing_phase);
    double value = rig.mass_kg * (kGravity * std::cos(angle) + rig.length_m * rate * rate) +
                   0.02 * rig.mass_kg * kGravity * angle;
    for (Index m = 0; m < 5 && s > 0; ++m) {
      const double omega = std::sqrt(modes.eigenvalues()[m]);
      const double zeta = rig.damping_ratio * std::sqrt(omega / std::sqrt(modes.eigenvalues()[0]));
      if (!(zeta < 1)) continue;
      const double damped = omega * std::sqrt(1 - zeta * zeta);
      const auto& shape = modes.eigenvectors().col(m);
      value += k * (shape[1] - shape[0]) * shape[n - 1] * impulse / damped *
               std::exp(-zeta * omega * s) * std::sin(damped * s);
    }
    value += rig.hum_N * std::sin(hum * t + hum_phase) + rig.noise_N * normal(random);
    tension[i] = rig.step_N > 0 ? rig.step_N * std::round(value / rig.step_N) : value;
  }
  signal::Recording recording{.format = "synthetic", .sample_rate_hz = rig.sample_rate_hz};
  signal::Channel channel{.name = "tension"};
  channel.unit = channel.source_unit = "N";
  channel.quantity = signal::Quantity::force;
  channel.samples = std::move(tension);
  recording.channels.push_back(std::move(channel));
  return recording;
}

AxialCoverage axial_coverage(const AxialStudy& study, int campaigns, unsigned seed) {
  AxialCoverage sum{.campaigns = campaigns};
  for (int k = 0; k < campaigns; ++k) {
    auto random = ident::random_stream(seed, static_cast<std::uint64_t>(k));
    std::normal_distribution<double> normal;
    ident::AxialInputs inputs{.setup = {.mass_kg = {study.rig.mass_kg, study.mass_std_kg}}};
    inputs.setup.mass_per_length_kg_m = {study.rig.mass_per_length_kg_m, study.per_length_std};
    inputs.setup.length_std_m = study.length_std_m;
    AxialRig rig = study.rig;
    if (study.frame_told_relative_std > 0) {
      const double off = 1 + study.frame_told_relative_std * normal(random);
      inputs.setup.frame_stated = true;
      inputs.setup.frame_stiffness_N_m = {rig.frame_N_m * off,
                                          study.frame_told_relative_std * rig.frame_N_m * off};
    }
    rig.mass_kg += study.mass_std_kg * normal(random);
    rig.mass_per_length_kg_m += study.per_length_std * normal(random);
    for (const double length : study.lengths_m) {
      rig.length_m = length + study.length_std_m * normal(random);
      for (int tap = 0; tap < study.taps; ++tap) {
        inputs.recordings.push_back({"tap", axial_rig_record(rig, random), length});
      }
    }
    const auto result = ident::axial_campaign(inputs);
    if (!result.test) {
      ++sum.refused;
      continue;
    }
    const auto& r = *result.test;
    bool warned = false;
    for (const auto& f : result.findings) {
      for (const char* code :
           {"one_length", "lengths_too_close", "lengths_disagree", "series_compliance"}) {
        warned = warned || f.code == code;
      }
    }
    const bool in = r.EA_N.low <= study.rig.EA_N && study.rig.EA_N <= r.EA_N.high;
    sum.covered += in, sum.warned += warned, sum.silently_wrong += !in && !warned;
    sum.relative_std += r.EA_N.std / r.EA_N.value;
    sum.bias += (r.EA_N.value - study.rig.EA_N) / r.EA_N.std;
  }
  const int given = std::max(1, campaigns - sum.refused);
  sum.relative_std /= given, sum.bias /= given;
  return sum;
}

}  // namespace rigfit::reference
