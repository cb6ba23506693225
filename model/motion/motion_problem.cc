#include "model/motion/motion_problem.h"

#include <algorithm>

namespace rigfit::model {

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
