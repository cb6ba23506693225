#include "model/motion/motion_problem.h"

#include <algorithm>
#include <cmath>

#include "model/chain/index.h"

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

bool joints_overdamp(const Chain& chain) {
  const auto mass = [](const Segment& s) { return s.mass * std::max(0.0, 1 - 4 * s.coupling); };
  const auto axial = [&](const Segment& s) {
    return s.axial_damping * s.axial_damping * s.length > s.EA * mass(s);
  };
  const auto bending = [&](const JointSprings& k, int segment) {
    const Segment& s = chain.segments[at(segment)];
    return 4 * k.bending_damping * k.bending_damping >
           std::min(k.about_1, k.about_2) * mass(s) * s.length * s.length;
  };
  return std::any_of(chain.segments.begin(), chain.segments.end(), axial) ||
         std::any_of(chain.inner_joints.begin(), chain.inner_joints.end(),
                     [&](const InnerJoint& j) { return bending(j.springs, j.segment[0]); }) ||
         std::any_of(chain.end_joints.begin(), chain.end_joints.end(),
                     [&](const EndJoint& j) { return bending(j.springs, j.segment); });
}

}  // namespace rigfit::model
