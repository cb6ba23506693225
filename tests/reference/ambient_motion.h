// Structures in ambient motion with exact truth, for tests and benchmarks.
//
// A mode under white forces obeys du = lambda u dt + dW with u = v - conj(lambda) x. It is advanced
// from sample to sample exactly, the modes' noise with its joint covariance, and a sensor gives the
// mean acceleration over a sample, (v_n+1 - v_n) / dt: the poles of the samples are exact.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "signal/recording/recording.h"

namespace rigfit::reference {

struct AmbientStructure {
  Eigen::VectorXd frequency_hz, damping_ratio;
  Eigen::MatrixXd shapes;  ///< channels x modes
  Eigen::MatrixXd forces;  ///< covariance of the modal forces
};

/// Equal storeys; a sensor on each.
[[nodiscard]] AmbientStructure storeys(Eigen::Index count, double first_hz, double damping_ratio);
/// Five of them: 0.8900, 2.5979, 4.0953, 5.2610, 6.0004 Hz.
[[nodiscard]] AmbientStructure five_storeys(double damping_ratio = 0.02);
/// Two modes about 2 Hz so far apart (relatively) with orthogonal shapes, damped by 1 %.
[[nodiscard]] AmbientStructure close_pair(double apart, Eigen::Index channels);

struct AmbientMotion {
  double rate_hz = 20, duration_s = 1200;
  double noise = 0.02;  ///< of the sensors, over the rms of each channel
  std::uint64_t seed = 1;
  std::function<double(double time_s)> amplitude = {};  ///< of the forces; empty: 1
};

/// Channels "c1", "c2", ...
[[nodiscard]] signal::Recording recorded(const AmbientStructure& structure,
                                         const AmbientMotion& motion);

}  // namespace rigfit::reference
