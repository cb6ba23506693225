// Dampers on the velocities of entries (motion_kernel.h), for schemes that integrate them apart
// from everything else: the exact decay of modal ratios, v += Phi (e^{-rate t} - 1) Phi' M v, and
// joint dampers M v' = -C(q) v by an L-stable SDIRK pair (gamma = 1 - sqrt(2)/2). C is taken a
// little ahead and renewed whenever a segment has turned by more than 2 mrad from there.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/chain/assembly.h"
#include "model/motion/motion_kernel.h"
#include "model/motion/motion_problem.h"

namespace rigfit::model {

template <int D>
class MotionDamper {
 public:
  /// The problem and the kernel must outlive this object.
  MotionDamper(const MotionProblem& problem, const MotionKernel<D>& kernel);

  [[nodiscard]] bool active() const { return joints_ || modal_; }
  /// Velocities after `time` (s) of the dampers alone, at these positions.
  void apply(double time, const Entries& positions, Eigen::Ref<Eigen::VectorXd> velocities);

 private:
  const Eigen::MatrixXd& decay(double time);
  void damp_joints(double time, const Entries& positions, Eigen::Ref<Eigen::VectorXd> velocities);
  [[nodiscard]] double turn(const Entries& from, const Entries& to) const;

  const MotionProblem& problem_;
  const MotionKernel<D>& kernel_;
  const Assembly& assembly_;
  EnvelopeMatrix mass_;
  bool joints_, modal_;
  Eigen::VectorXd u_, w_;
  // Modal ratios: e^{-rate t} - 1 as a matrix over the unknowns, for each time asked so far.
  Eigen::MatrixXd momentum_;
  struct Decay {
    double time;
    Eigen::MatrixXd matrix;
  };
  std::vector<Decay> decays_;
  // Joint dampers: C, and the factors of M + gamma t C for each time asked so far.
  EnvelopeMatrix damping_, system_;
  Eigen::VectorXd damped_at_;  // positions
  struct Factor {
    double time;
    EnvelopeFactor factor;
  };
  std::vector<Factor> factors_;
};

extern template class MotionDamper<2>;
extern template class MotionDamper<3>;

}  // namespace rigfit::model
