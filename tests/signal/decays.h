// Free decays for tests, and what tests ask of their estimates.
#pragma once

#include "signal/decay/decay.h"
#include "tests/test.h"

namespace rigfit::testing {

struct DecayingMode {
  double f, zeta, amplitude = 1;
};

/// Pole in radians a sample.
inline std::complex<double> pole(const DecayingMode& m, double rate) {
  const double w = 2 * std::numbers::pi * m.f / rate;
  return {-m.zeta * w, w * std::sqrt(1 - m.zeta * m.zeta)};
}

/// Adds a decay of this phase that begins at sample `first`.
inline void add_decay(Eigen::VectorXd& y, const DecayingMode& m, double rate, double phase = 0,
                      Eigen::Index first = 0) {
  const std::complex<double> a = std::polar(m.amplitude, phase), p = pole(m, rate);
  for (Eigen::Index j = first; j < y.size(); ++j) {
    y(j) += (a * std::exp(p * static_cast<double>(j - first))).real();
  }
}

inline void add_noise(Eigen::VectorXd& y, double std, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  for (double& v : y) v += std * normal(random);
}

/// Within so many of its standard uncertainties.
inline void expect_mode(const signal::DecayMode& mode, double f, double zeta, double stds = 5) {
  EXPECT_NEAR(mode.frequency_hz.value, f, stds * mode.frequency_hz.std);
  EXPECT_NEAR(mode.damping_ratio.value, zeta, stds * mode.damping_ratio.std);
}

}  // namespace rigfit::testing
