// When a time history is sampled, and the account of its energy.
#pragma once

#include <vector>

#include "model/chain/energy_account.h"

namespace rigfit::model {

/// Duration, rate and number of entries of the energy account.
struct SamplingOptions {
  double duration_s = 1;
  double rate_hz = 1000;
  int energy_samples = 200;         ///< instants of the energy account besides the first; 0: none
  [[nodiscard]] long rows() const;  ///< samples at 0, 1/rate, ... up to the duration
  /// Rows between two entries of the energy account.
  [[nodiscard]] long energy_stride() const;
};

/// Where the energy was over time: J, by member and kind.
struct EnergyHistory {
  std::vector<double> time_s;
  std::vector<EnergyAccount> account;
  std::vector<double> supplied;    ///< by loads since t = 0
  std::vector<double> dissipated;  ///< by dampers since t = 0

  /// Largest |E(t) - E(0) - supplied + dissipated| over the energy that was in motion: the largest
  /// kinetic energy there was. Zero for a history without motion.
  [[nodiscard]] double drift() const;
};

}  // namespace rigfit::model
