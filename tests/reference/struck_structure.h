// Hammer hits on a structure simulated in time, with the defects that real ones have: white
// noise on force and responses, a structure that changes from hit to hit, a converter's steps, a
// hammer off its axis and place.
//
// Each mode q'' + 2 zeta w q' + w^2 q = phi f(t) is stepped at 8 times the sampling rate with the
// exact solution for a force that is linear between the steps; a half sine of 16 such steps or more
// differs from its chords by 0.2 % of its area, the same for all frequencies far below 1 /
// duration. A low-pass (Blackman-windowed sinc of 32 samples, alike on all channels) precedes the
// sampling, as in a logger. Nothing here knows of transforms or FRFs.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "signal/recording/recording.h"

namespace rigfit::testing {

struct StruckStructure {
  Eigen::VectorXd frequency_hz;
  Eigen::VectorXd damping_ratio;
  Eigen::MatrixXd shapes;  ///< responses x modes; response 0 is struck

  /// Modes at 9.3, 21.7, 38.1 and 55.2 Hz, 0.6 to 1.2 % damped, shapes of a beam.
  explicit StruckStructure(Eigen::Index responses);
};

struct StrikeOptions {
  int hits = 5;
  double sample_rate_hz = 1024;
  double before_s = 0.5, after_s = 11.5;  ///< time before and after the hit
  double pulse_s = 8e-3;
  double force_noise = 0;        ///< std, of the mean peak
  double response_noise = 2e-3;  ///< std, of the response's rms after a hit of mean size
  /// Relative standard deviation of all frequencies from hit to hit (by stiffness, temperature or
  /// size of the hit), alike for all modes.
  double frequency_scatter = 0;
  double converter_bits = 0;  ///< steps of every channel: full scale / 2^bits; 0: none
  /// Each hit off the axis by an angle of this standard deviation, rad. Across, the struck place
  /// moves by 0.7 of the modes' amplitude, as 0.7 cos(r pi x) beside sin(r pi x).
  double off_axis = 0;
  double off_place = 0;  ///< each hit off the place, standard deviation, over the length
  std::uint64_t seed = 1;
};

/// One recording a hit: channel "force" (N), accelerations "a1".. (m/s^2).
[[nodiscard]] std::vector<signal::Recording> struck_recordings(const StruckStructure& structure,
                                                               const StrikeOptions& options);

}  // namespace rigfit::testing
