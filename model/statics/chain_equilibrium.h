// State of an equilibrium that is sought (equilibrium.h).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "model/chain/assembly.h"
#include "model/chain/chain.h"
#include "model/scene/scene.h"
#include "model/statics/equilibrium_result.h"

namespace rigfit::model {

struct ChainEquilibrium {
  EquilibriumStatus status = EquilibriumStatus::not_converged;
  std::string reason;
  double residual = 0;  ///< largest unbalanced force over the largest member force
  int iterations = 0;
  ChainState state;
};

/// A motion about the equilibrium.
struct RestMotion {
  Motion motion = Motion::space;
  std::unique_ptr<Assembly> assembly;  ///< energies and forces of the chain at rest
  EnvelopeMatrix stiffness;
};

}  // namespace rigfit::model
