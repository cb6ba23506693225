// Ten modes of a member with sensors along it, in continuous time and as a sampled system whose
// records and frequency response functions are exact.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "signal/spectra/frf_set.h"

namespace rigfit::apps {

struct TenModes {
  Eigen::VectorXd frequency_hz, damping_ratio;
  Eigen::MatrixXd shapes;  ///< responses x modes, kg^-1/2; the first response is struck

  explicit TenModes(Eigen::Index responses);
  [[nodiscard]] Eigen::VectorXcd poles() const;  ///< rad/s, upper ones

  /// Accelerance s^2 sum_r phi phi' / (s^2 + 2 zeta w s + w^2) at s = i 2 pi f, lines x responses,
  /// with white noise of `noise` times its rms.
  [[nodiscard]] signal::FrfSet frfs(const Eigen::VectorXd& lines_hz, double noise,
                                    std::uint64_t seed) const;
};

/// The sampled system y_n = sum_r 2 Re(R_r x_n), x_n = z_r x_(n-1) + f_n, z_r = exp(p_r / rate):
/// H(z) = sum_r R_r / (1 - z_r / z) + conj.
struct SampledStructure {
  Eigen::VectorXcd z;
  Eigen::MatrixXcd residues;  ///< responses x modes
  double rate_hz = 0;

  SampledStructure(const TenModes& modes, double sample_rate_hz);
  /// Exact, lines x responses, at z = exp((i 2 pi f + decay_rate) / rate).
  [[nodiscard]] Eigen::MatrixXcd frfs(const Eigen::VectorXd& lines_hz, double decay_rate_1_s) const;
  /// samples x (1 + responses): force, then responses, for a half-sine blow of `contact` samples
  /// that begins at sample `start`; white noise of `noise` times each channel's rms.
  [[nodiscard]] Eigen::MatrixXd hit(Eigen::Index samples, Eigen::Index start, int contact,
                                    double peak, double noise, std::uint64_t seed) const;
};

}  // namespace rigfit::apps
