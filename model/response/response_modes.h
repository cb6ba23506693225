// The modes that a response is made of: those of the motions that some load drives, and how much
// each matters.
#pragma once

#include <vector>

#include "model/linear/modes.h"
#include "model/response/linear_answer.h"

namespace rigfit::model {

/// Equilibrium and matrices of every motion; modes only of those that a load drives (of the first
/// when none does): all up to 400 unknowns a motion, else the lowest 200. `segments` by member;
/// empty: the scene's own, 30 where it says "auto". `order` stays empty.
[[nodiscard]] ChainModes response_modes(const Scene& scene, const std::vector<int>& segments);

/// What each mode and each pole of a linear answer has of the motion after the last force.
struct ModeWeights {
  Eigen::VectorXd energy;  ///< by mode: share of the energy
  double mean_omega2 = 0;  ///< (rad/s)^2, by energy and its mean over the duration
  /// By pole: share of what the sensors read (mean square over the duration, decay included, each
  /// sensor in its own quantity and counting the same).
  Eigen::VectorXd sensors;
  std::vector<int> mode_of_pole;
};
[[nodiscard]] ModeWeights mode_weights(const LinearAnswer& answer, const Scene& scene,
                                       const std::vector<const ForceHistory*>& records,
                                       double duration_s);

struct ResponseResolution {
  ChainModes modes;
  LinearAnswer answer;
  double relative_error = 0;  ///< error of the modes' frequencies, weighted by their energy
};

/// The frequencies' error by segments: from twice as many, second order; weighted by energy.
[[nodiscard]] double resolution_error(const Scene& scene, const ChainModes& modes,
                                      const LinearAnswer& answer, const ModeWeights& weights);

/// Members that say "auto" get as many segments, all the same number, as bring that error below the
/// scene's accuracy: 30 to 400.
[[nodiscard]] ResponseResolution choose_response_segments(
    const Scene& scene, const std::vector<const ForceHistory*>& records, double duration_s);

}  // namespace rigfit::model
