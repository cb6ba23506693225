// Natural frequencies of many scenes of one topology: Monte Carlo draws, sweeps, starts of a fit.
//
// Every scene is solved as one to four chains of few segments, taken to no length by Neville's
// value. What is left of the segments' error, a correction of ln f, changes little from scene to
// scene: it is found for a few scenes (segment_extrapolation.h) and fitted, mode by mode, by a
// polynomial in the first principal components of all scenes' ln f. Those few lie farthest apart in
// these components, so that the others lie between them. The error is that of predicting each of
// them from the others. The cheapest set of chains that meets the accuracy is taken; where none
// does, every scene is extrapolated by itself.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "model/linear/natural_mode.h"
#include "model/scene/scene.h"

namespace rigfit::model {

/// Frequencies of all scenes, and how they were found.
struct ModeBatch {
  Eigen::MatrixXd frequency_hz;  ///< scenes x modes asked for, rising; zero where not solved
  std::vector<std::vector<ModePlane>> plane;  ///< likewise; empty where not solved
  std::vector<bool> solved;            ///< false: no equilibrium, or fewer modes than asked for
  double relative_error_estimate = 0;  ///< largest of all solved ones
  int extrapolated = 0;                ///< scenes extrapolated by themselves
  std::vector<int> segments;  ///< of the others' longest chain, by member; empty: there are none
};

/// First `options.count` modes of every scene to `accuracy` (relative), whatever segments the
/// members say; `options.band_hz`, `segments`, `damped` and `shapes` are not used. Scenes may
/// differ in all numbers; those that differ in members or planes from the first are extrapolated by
/// themselves.
[[nodiscard]] ModeBatch batch_modes(std::span<const Scene> scenes, const ModesOptions& options,
                                    double accuracy);

}  // namespace rigfit::model
