// A scene's linear motion about its equilibrium, as poles: all its natural modes with modal ratios
// (diagonal) or joint dampers (coupled: eigenvalues of the state matrix in modal coordinates), and
// what each has of the motion after the last force.
#pragma once

#include "model/algebra/numbers.h"
#include "model/linear/modes.h"
#include "model/response/modal_response.h"
#include "model/scene/scene.h"

namespace rigfit::model {

struct LinearAnswer {
  ChainModes modes;                     ///< without an equilibrium the rest is empty
  PoleModel sensors;                    ///< output: the scene's sensors
  PoleModel modal;                      ///< the same poles; output: each mode's coordinate
  VectorXd omega;                       ///< rad/s, modes of all motions one after the other
  VectorXd ratio;                       ///< from the members' damping ratios alone
  std::vector<ChainModes::Which> mode;  ///< motion and mode of each
  bool truncated = false;               ///< not all modes of the chain are in it
  VectorXd energy;                      ///< by mode: share of the energy
  double mean_omega2 = 0;               ///< (rad/s)^2, by energy and its mean over the duration
  /// By pole: share of what the sensors read (mean square over the duration, decay included, each
  /// sensor in its own quantity and counting the same).
  VectorXd sensed;
  std::vector<Index> mode_of_pole;
  double resolution_error = -1;  ///< of choose_response_segments; negative: not estimated
};

/// `forces`: by load of the scene.
[[nodiscard]] LinearAnswer linear_answer(ChainModes modes, const Scene& scene,
                                         const std::vector<LoadForce>& forces, double duration_s);

/// By load, the weight of the mass that a release hangs there, N along its direction; else zero.
[[nodiscard]] VectorXd hung_weights(const Scene& scene);

/// Increments of one numbering's unknowns as another's; what the other lacks is left out.
[[nodiscard]] VectorXd renumbered(const VectorXd& x, const Numbering& from, const Numbering& to);

}  // namespace rigfit::model
