// A chain set in motion from a given state, and what came of it: shared by every integrator of the
// geometrically exact equations
//   M q'' + C(q) q' + D q' + dV/dq = sum of load rows x forces,
// C from the joint dampers, D = sum over modes of M phi 2 zeta omega phi' M from modal ratios.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/chain/assembly.h"
#include "model/chain/chain.h"
#include "model/motion/sampling.h"
#include "model/scene/force_history.h"

namespace rigfit::model {

/// Modal ratios as a viscous force: each mode's velocity decays at `rate`.
struct ModalDamping {
  Eigen::MatrixXd shapes;  ///< unknowns (of the problem's motion) x modes, mass-normalised
  Eigen::VectorXd rate;    ///< 2 zeta omega, 1/s
  [[nodiscard]] bool none() const { return rate.size() == 0 || rate.isZero(0); }
};

struct MotionProblem {
  const Chain* chain = nullptr;      ///< settled
  Motion motion = Motion::in_plane;  ///< in_plane or space
  ChainState rest;                   ///< equilibrium; displacements are counted from here
  ChainState start;
  Eigen::VectorXd start_velocity;            ///< velocity of the motion's unknowns; empty: at rest
  std::vector<Load> loads;                   ///< in the order of the chain's loads
  std::vector<const ForceHistory*> records;  ///< one a load, null where it has none
  std::vector<Sensor::Quantity> quantities;  ///< one a sensor of the chain
  bool joint_damping = false;
  ModalDamping modal_damping;
};

struct MotionOutput {
  Eigen::MatrixXd samples;  ///< rows x sensors, at 0, 1/rate, ...
  EnergyBalance energy;
  double step_s = 0;
  double axial_slowing_s2 = 0;  ///< kappa of node_mass.h; 0: axial waves at their own speed
  long steps = 0;
  bool completed = false;  ///< false: diverged or did not converge, samples are not to be used
  std::string reason;      ///< for a person, when not completed
};

/// Whether joint dampers overdamp some wave of a chain of such segments: d omega / (2 k) > 1 for
/// the fastest axial wave, omega^2 = 4 k / m, or bending wave, omega^2 = 16 k / (m l^2), of
/// stiffness k, damper d and mass m = (1 - 4 coupling) of a segment's. Such dampers do not split
/// from the elastic forces that they are in balance with: splitting errs in proportion to its
/// interval.
[[nodiscard]] bool joints_overdamp(const Chain& chain);

}  // namespace rigfit::model
