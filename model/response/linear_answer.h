// A scene's linear motion about its equilibrium, as poles: all its natural modes with modal ratios
// (diagonal) or joint dampers (coupled: eigenvalues of the state matrix in modal coordinates).
#pragma once

#include "model/algebra/numbers.h"
#include "model/linear/modes.h"
#include "model/response/modal_response.h"
#include "model/scene/scene.h"

namespace rigfit::model {

struct LinearAnswer {
  PoleModel sensors;                    ///< output: the scene's sensors
  PoleModel modal;                      ///< the same poles; output: each mode's coordinate
  VectorXd omega;                       ///< rad/s, modes of all motions one after the other
  VectorXd ratio;                       ///< from the members' damping ratios alone
  std::vector<ChainModes::Which> mode;  ///< motion and mode of each
  bool truncated = false;               ///< not all modes of the chain are in it
};

[[nodiscard]] LinearAnswer linear_answer(const ChainModes& modes, const Scene& scene);

/// By load, the weight of the mass that a release hangs there, N along its direction; else zero.
[[nodiscard]] VectorXd hung_weights(const Scene& scene);

/// Increments of one numbering's unknowns as another's; what the other lacks is left out.
[[nodiscard]] VectorXd renumbered(const VectorXd& x, const Numbering& from, const Numbering& to);

}  // namespace rigfit::model
