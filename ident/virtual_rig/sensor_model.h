// From what happens at a sensor to what a logger writes: sensitivity, transverse sensitivity,
// offset, drift, noise, quantisation and clipping. Part of the virtual laboratory; every recording
// made with it is synthetic.
//
//   y = clip( quantise( x + t x_transverse + offset + drift(t) + noise ) )
// Drift is a straight line plus a random walk; noise is white over the logger's band.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

namespace rigfit::ident {

struct SensorModel {
  double noise_std = 0;               ///< of one sample, in the unit of the signal
  double offset_std = 0;              ///< constant offset drawn once a record
  double drift_per_s = 0;             ///< standard deviation of the slope drawn once a record
  double random_walk_per_root_s = 0;  ///< standard deviation after 1 s
  double transverse_sensitivity = 0;  ///< share of the transverse signal, 0..1
  double full_scale = 0;              ///< +-, beyond it the logger clips; 0: never
  int bits = 0;                       ///< of the converter over 2 full_scale; 0: not quantised
};

/// Seeded random numbers that are the same on every run.
using Random = std::mt19937_64;

/// What the logger writes of `signal` (one sample a step of `dt_s`); `transverse` has the same
/// length or is empty. Throws std::invalid_argument for different lengths or a converter without
/// full scale.
[[nodiscard]] Eigen::VectorXd recorded(const Eigen::Ref<const Eigen::VectorXd>& signal,
                                       const Eigen::Ref<const Eigen::VectorXd>& transverse,
                                       double dt_s, const SensorModel& sensor, Random& random);

/// A generator for one part of a laboratory, independent of the others for the same seed.
[[nodiscard]] Random random_stream(std::uint64_t seed, std::uint64_t stream);

}  // namespace rigfit::ident
