#include "model/motion/motion_problem.h"

#include <algorithm>
#include <cmath>

namespace rigfit::model {

double EnergyHistory::drift() const {
  double moving = 0, worst = 0;
  for (std::size_t i = 0; i < account.size(); ++i) {
    const Energy now = account[i].sum();
    moving = std::max(moving, now.kinetic);
    worst = std::max(
        worst, std::abs(now.total() - account[0].sum().total() - supplied[i] + dissipated[i]));
  }
  return moving > 0 ? worst / moving : 0;
}

long SamplingOptions::rows() const {
  return static_cast<long>(std::floor(duration_s * rate_hz * (1 + 1e-12))) + 1;
}

long SamplingOptions::energy_stride() const {
  return energy_samples > 0 ? std::max(1L, (rows() - 1) / energy_samples) : rows();
}

bool any_joint_damping(const Chain& chain) {
  const auto damped = [](const JointSprings& springs) {
    return springs.bending_damping > 0 || springs.torsion_damping > 0;
  };
  return std::any_of(chain.segments.begin(), chain.segments.end(),
                     [](const Segment& s) { return s.axial_damping > 0; }) ||
         std::any_of(chain.inner_joints.begin(), chain.inner_joints.end(),
                     [&](const InnerJoint& j) { return damped(j.springs); }) ||
         std::any_of(chain.end_joints.begin(), chain.end_joints.end(),
                     [&](const EndJoint& j) { return damped(j.springs); });
}

}  // namespace rigfit::model
