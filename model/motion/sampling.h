// Sampling of a time history, and its energy balance.
#pragma once

#include <optional>

namespace rigfit::model {

/// Duration, rate and number of instants of the energy balance.
struct SamplingOptions {
  double duration_s = 1;
  double rate_hz = 1000;
  int energy_samples = 200;         ///< instants of the energy balance after the first; 0: none
  [[nodiscard]] long rows() const;  ///< samples at 0, 1/rate, ... up to the duration
  /// Rows between two instants of the balance.
  [[nodiscard]] long energy_stride() const;
};

/// Energy balance of a motion, J.
struct EnergyBalance {
  double supplied = 0;    ///< by loads since t = 0
  double dissipated = 0;  ///< by dampers since t = 0
  double kinetic = 0;     ///< largest over all instants
  double worst = 0;       ///< largest |E(t) - E(0) - supplied + dissipated|
  double rounding = 0;    ///< by scheme or tolerance: kinetic energy below it is no motion

  /// Adds the next instant.
  void add(double potential_J, double kinetic_J, double supplied_J, double dissipated_J);
  /// `worst` over the largest kinetic energy; zero without motion.
  [[nodiscard]] double drift() const { return kinetic > rounding ? worst / kinetic : 0; }

 private:
  std::optional<double> start_;
};

}  // namespace rigfit::model
