// A chain set in motion from a given state, and what came of it: shared by every integrator of the
// geometrically exact equations
//   M q'' + C(q) q' + D q' + dV/dq = sum of load rows x forces,
// C from the joint dampers, D = sum over modes of p 2 zeta omega p' from modal ratios. At rest p =
// M phi = K phi / omega^2; its part by the segments' elongations turns with them: bending shortens
// a beam's chord, and in M phi that would be damped as an axial wave's motion.
#pragma once

#include "model/algebra/numbers.h"
#include "model/chain/assembly.h"
#include "model/chain/chain.h"
#include "model/motion/sampling.h"
#include "model/scene/force_history.h"

namespace rigfit::model {

/// Modal ratios as a viscous force: each mode's velocity decays at `rate`. The modes of one of the
/// chain's motions (in the plane, out of it), which do not move the others' unknowns.
struct DampedModes {
  std::vector<int> unknowns;  ///< those of the problem's motion that the modes move
  MatrixXd shapes;            ///< these unknowns x modes, mass-normalised
  MatrixXd momentum;          ///< M times the shapes, without what the elongations give
  MatrixXd axial;             ///< segments x modes: axial stiffness times elongation over omega^2
  VectorXd rate;              ///< 2 zeta omega, 1/s
};

struct MotionProblem {
  const Chain* chain = nullptr;      ///< settled
  Motion motion = Motion::in_plane;  ///< in_plane or space
  ChainState rest;                   ///< equilibrium; displacements are counted from here
  ChainState start;
  VectorXd start_velocity;                   ///< velocity of the motion's unknowns; empty: at rest
  std::vector<LoadForce> loads;              ///< in the order of the chain's loads
  std::vector<Sensor::Quantity> quantities;  ///< one a sensor of the chain
  bool joint_damping = false;
  std::vector<DampedModes> damped_modes;  ///< empty: no modal damping
};

}  // namespace rigfit::model
