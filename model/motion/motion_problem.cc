#include "model/motion/motion_problem.h"

#include <algorithm>
#include <cmath>

#include "model/chain/index.h"

namespace rigfit::model {

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
