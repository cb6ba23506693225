// Turns the signal at a sensor into the samples that a logger writes: sensitivity, transverse
// sensitivity, offset, drift, noise, quantisation and clipping. Part of the virtual laboratory;
// every recording made with it is synthetic.
//
//   y = clip( quantise( x + t x_transverse + offset + drift(t) + noise ) )
// Drift is a straight line plus a random walk; noise is white over the logger's band.
#pragma once

#include <cstdint>
#include <random>

#include "ident/statistics/numbers.h"
#include "signal/recording/recording.h"

namespace rigfit::ident {

struct SensorModel {
  double noise_std = 0;               ///< noise of one sample, in the unit of the signal
  double offset_std = 0;              ///< constant offset drawn once per record
  double drift_per_s = 0;             ///< standard deviation of the slope, drawn once per record
  double random_walk_per_root_s = 0;  ///< standard deviation after 1 s
  double transverse_sensitivity = 0;  ///< share of the transverse signal, 0..1
  double full_scale = 0;              ///< +-, beyond it the logger clips; 0: never
  int bits = 0;                       ///< bits of the converter over 2 full_scale; 0: not quantised
};

/// The instruments of the paper's rig, with ranges and noise typical of data sheets for their
/// class: a hammer of about 2 mV/N into a 24-bit converter of +-10 V, accelerometers of 100 mV/g
/// with 1 % to 5 % transverse sensitivity, a 500 N tension cell and a 50 N load cell on 16-bit
/// converters, an LVDT of +-25 mm.
struct VirtualInstruments {
  SensorModel hammer{.noise_std = 0.02, .offset_std = 0.05, .full_scale = 4400, .bits = 24};  ///< N
  SensorModel accelerometer{.noise_std = 3e-3,
                            .offset_std = 0.02,
                            .drift_per_s = 1e-3,
                            .random_walk_per_root_s = 1e-3,
                            .transverse_sensitivity = 0.03,
                            .full_scale = 690,
                            .bits = 24};  ///< m/s^2
  SensorModel tension_cell{.noise_std = 0.05,
                           .offset_std = 0.1,
                           .drift_per_s = 1e-4,
                           .random_walk_per_root_s = 1e-3,
                           .full_scale = 500,
                           .bits = 16};  ///< N
  SensorModel load_cell{.noise_std = 0.005,
                        .offset_std = 0.02,
                        .drift_per_s = 1e-4,
                        .random_walk_per_root_s = 5e-4,
                        .full_scale = 50,
                        .bits = 16};  ///< N
  SensorModel lvdt{.noise_std = 2e-6,
                   .offset_std = 5e-5,
                   .drift_per_s = 1e-8,
                   .random_walk_per_root_s = 1e-7,
                   .full_scale = 0.025,
                   .bits = 16};  ///< m
};

/// Seeded random numbers that are the same on every run.
using Random = std::mt19937_64;

/// Samples that the logger writes for `signal` (one per step of `dt_s`); `transverse` has the same
/// length or is empty. Throws std::invalid_argument for different lengths or a converter without
/// full scale.
[[nodiscard]] VectorXd recorded(const Ref<const VectorXd>& signal,
                                const Ref<const VectorXd>& transverse, double dt_s,
                                const SensorModel& sensor, Random& random);

/// A virtual recording without channels.
[[nodiscard]] signal::Recording virtual_recording(double sample_rate_hz);

/// Adds what the logger writes for `signal` to a recording; the other arguments as of `recorded`,
/// null: `signal` itself.
void add_channel(signal::Recording& recording, std::string name, signal::Quantity quantity,
                 const Ref<const VectorXd>& signal, const SensorModel* sensor, Random& random,
                 const Vector3d& direction = {0, 0, 0},
                 const Ref<const VectorXd>& transverse = VectorXd());

/// A generator for one part of a laboratory, independent of the others for the same seed.
[[nodiscard]] Random random_stream(std::uint64_t seed, std::uint64_t stream);

}  // namespace rigfit::ident
