// Where a chain rests under additional dead loads, geometrically exact: the start of a release.
//
// Newton's method from the unloaded equilibrium by load steps; the geometric stiffness takes the
// axial force that the last step extrapolates (see Assembly::force_and_tangent). A load step moves
// nothing by more than a quarter of the rig and ends in a stable state: a slender beam that its
// load bends through ninety degrees has other equilibria too.
#pragma once

#include <Eigen/Core>

#include "model/chain/assembly.h"

namespace rigfit::model {

struct LoadedState {
  bool converged = false;
  ChainState state;
  double residual = 0;  ///< largest unbalanced force over the largest load or axial force
  int iterations = 0;
};

/// `load`: generalised forces in the assembly's unknowns, N and N m.
[[nodiscard]] LoadedState loaded_state(const Assembly& assembly, const ChainState& equilibrium,
                                       const Eigen::VectorXd& load);

}  // namespace rigfit::model
