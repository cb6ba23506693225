// FRFs of a roving test with the defects that measured ones have, from a truth that is known.
//
// Accelerances of a bar with sine shapes, H = sum_r s^2 phi_ro phi_ri [1/(2 i w_d (s - p_r)) +
// conj], less what a record of accelerations that ends early lacks, each point under poles of its
// own: f_r (1 + 2 zeta_r (drift x_c + scatter n_c)), x_c from -1/2 to 1/2 over the points, n_c
// normal. A mean rig has the nominal poles.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "signal/spectra/frf_set.h"

namespace rigfit::testing {

struct DefectiveFrfOptions {
  Eigen::VectorXd frequency_hz = (Eigen::VectorXd(3) << 100, 173, 268).finished();
  double damping_ratio = 5e-4;
  double low_hz = 80, high_hz = 300, spacing_hz = 0.025;
  Eigen::Index points = 8;
  bool points_are_inputs = true;  ///< roving hammer; else roving sensor
  /// Where the fixed sensors (or the fixed hammer) are, of the length.
  std::vector<double> fixed = {0.37};
  double noise = 2e-3;          ///< noise on each part of H, over the rms FRF
  double drift = 0;             ///< first to last point, half-power bandwidths
  double scatter = 0;           ///< standard deviation between points, half-power bandwidths
  double common = 0;            ///< noise on the force: relative, the same for all FRFs of a line
  double record_s = 0;          ///< length of the records, cut off; 0: whole decay
  double before_hit_s = 0;      ///< of `record_s`, before the hit
  double window_decay_1_s = 0;  ///< exponential window on force and response, from the hit on
  std::uint64_t seed = 1;
};

[[nodiscard]] signal::FrfSet defective_frfs(const DefectiveFrfOptions& options);

}  // namespace rigfit::testing
