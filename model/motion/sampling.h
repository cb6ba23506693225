// Sampling of a time history, its energy balance, and what came of a motion.
#pragma once

#include "model/algebra/numbers.h"

namespace rigfit::model {

/// Duration and rate.
struct SamplingOptions {
  double duration_s = 1;
  double rate_hz = 1000;
  /// Samples at 0, 1/rate, ... up to the duration.
  [[nodiscard]] long rows() const {
    return static_cast<long>(std::floor(duration_s * rate_hz * (1 + 1e-12))) + 1;
  }
  /// Rows between two of the some 20 instants of the energy balance.
  [[nodiscard]] long energy_stride() const { return std::max(1L, (rows() - 1) / 20); }
};

/// Energy balance of a motion, J.
struct EnergyBalance {
  double supplied = 0;    ///< by loads since t = 0
  double dissipated = 0;  ///< by dampers since t = 0
  double kinetic = 0;     ///< largest over all instants
  double worst = 0;       ///< largest |E(t) - E(0) - supplied + dissipated|
  double rounding = 0;    ///< by scheme or tolerance: kinetic energy below it is no motion

  /// Adds the next instant.
  void add(double potential_J, double kinetic_J, double supplied_J, double dissipated_J) {
    const double left = potential_J + kinetic_J - supplied_J + dissipated_J;
    if (!start_) start_ = left;
    supplied = supplied_J;
    dissipated = dissipated_J;
    kinetic = std::max(kinetic, kinetic_J);
    worst = std::max(worst, std::abs(left - *start_));
  }
  /// `worst` over the largest kinetic energy; zero without motion.
  [[nodiscard]] double drift() const { return kinetic > rounding ? worst / kinetic : 0; }

 private:
  std::optional<double> start_;
};

/// A motion that was computed.
struct MotionOutput {
  MatrixXd samples;  ///< rows x sensors, at 0, 1/rate, ...
  EnergyBalance energy;
  double step_s = 0;
  double axial_slowing_s2 = 0;  ///< kappa of node_mass.h; 0: axial waves at their own speed
  long steps = 0;
  bool completed = false;  ///< false: diverged or did not converge, samples are not to be used
  std::string reason;      ///< for a person, when not completed
};

}  // namespace rigfit::model
