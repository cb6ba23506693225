// A rig with one of its numbers changed a little, in its equilibrium: what
// sensitivities of modes and FRFs are made of.
//
// With R(u, p) = 0 the equilibrium, u the displacements and the unknown unstretched lengths, the
// state moves by du/dp = -J^-1 dR/dp, J the bordered tangent (equilibrium.h), factored once for all
// parameters; a few corrections with it bring each side to rest. Central differences of matrices
// assembled there (one-sided at a bound of zero) are dK/dp, dM/dp, dC/dp with the change of the
// equilibrium in them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>

#include "model/algebra/bordered_solver.h"
#include "model/linear/modes.h"
#include "model/scene/parameters.h"

namespace rigfit::model {

struct PerturbedEquilibrium {
  Scene scene;
  Chain chain;
  ChainState state;
  std::unique_ptr<Assembly> assembly;  ///< of `chain` while it is brought to rest
};

/// Two values of a parameter, `low` <= `value` < `high`.
struct ParameterStep {
  double value = 0, low = 0, high = 0;
  [[nodiscard]] double width() const { return high - low; }
};

/// `extent`: the rig's largest length, m. A number that may not be negative is stepped to one side
/// from zero.
[[nodiscard]] ParameterStep parameter_step(const ParameterAccess& access, const Scene& scene,
                                           double extent);

class EquilibriumPerturber {
 public:
  /// `modes` (its equilibrium converged) and `scene` must outlive this.
  EquilibriumPerturber(const Scene& scene, const ChainModes& modes);
  /// The rig at `step.low` and `step.high`, which come closer where the rig moves far. False: a
  /// scene beside this one has other unknowns (a plane of symmetry is lost), so that its matrices
  /// do not compare.
  [[nodiscard]] bool move(const ParameterAccess& access, ParameterStep& step,
                          std::array<PerturbedEquilibrium, 2>& rigs) const;

 private:
  [[nodiscard]] bool beside(const ParameterAccess& access, const std::array<double, 2>& points,
                            std::array<PerturbedEquilibrium, 2>& rigs) const;
  /// The force and the tensions that are lacking.
  void unbalanced(const PerturbedEquilibrium& rig, Eigen::VectorXd& force,
                  Eigen::VectorXd& tension) const;
  void advance(PerturbedEquilibrium& rig, const Eigen::VectorXd& by,
               const Eigen::VectorXd& by_length, double factor) const;
  const Scene& scene_;
  const ChainModes& modes_;
  Chain loose_;
  std::unique_ptr<Assembly> assembly_;
  std::vector<int> targets_;  // members whose tension is given
  BorderedSolver bordered_;
};

/// Stiffness and mass of a perturbed equilibrium in the motion `like` of the rig itself, without
/// modes.
[[nodiscard]] MotionModes motion_of(const PerturbedEquilibrium& rig, const MotionModes& like);

}  // namespace rigfit::model
