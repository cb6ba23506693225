#include "model/motion/motion_kernel.h"

#include <cassert>

namespace rigfit::model {
namespace {

// Bending stiffness about the chain's z axis.
double in_plane_stiffness(const Chain& chain, const JointSprings& springs, int segment) {
  const int frame = chain.segments[at(segment)].frame;
  if (frame < 0) return springs.about_1;
  return std::abs(chain.drawn_director(2, frame)) > 0.5 ? springs.about_1 : springs.about_2;
}

}  // namespace

bool kernel_supports(const Chain& chain, int dimensions) {
  if (chain.members.empty()) return false;
  if (dimensions == 2) return chain.planar;
  return chain.frames == 0 && chain.rotating_node.empty();
}

template <int D>
MotionKernel<D>::MotionKernel(const Chain& chain)
    : chain_(&chain), assembly_(chain, D == 2 ? Motion::in_plane : Motion::space) {
  assert(kernel_supports(chain, D));
  entry_of_node_.assign(at(chain.nodes), -1);
  turning_.resize(chain.rotating_node.size());
  if constexpr (D == 2) {
    for (std::size_t r = 0; r < turning_.size(); ++r) {
      turning_[r].held = chain.rotation_fixed(2, static_cast<Index>(r));
    }
  }
  make_members();
  for (const NodeSupport& support : chain.supports) {
    for (SharedNode& node : shared_) {
      if (node.node != support.node) continue;
      node.spring += support.translational;
      springs_ = true;
      node.anchor = chain.drawn.col(support.node);
    }
    if (support.rotation >= 0) turning_[at(support.rotation)].spring += support.rotational(2);
  }
  gravity_ = covector(assembly_.weight());
  mass_ =
      NodeMass<D>({members_.begin(), members_.end()}, {shared_.begin(), shared_.end()}, entries_);
}

template <int D>
void MotionKernel<D>::make_members() {
  const Chain& chain = *chain_;
  const Numbering& numbering = assembly_.numbering();
  EnvelopeMatrix masses = assembly_.matrix();
  assembly_.mass(masses);
  // Along an axis in which both nodes are free.
  const auto mass_between = [&](int a, int b) {
    for (int c = 0; c < D; ++c) {
      const int i = numbering.displacement(c, a), j = numbering.displacement(c, b);
      if (i >= 0 && j >= 0) return masses.at(i, j);
    }
    return 0.0;
  };
  std::vector<int> shared_of_node(at(chain.nodes), -1);
  for (const ChainMember& member : chain.members) {
    MemberPlan plan;
    plan.offset = entries_;
    plan.segments = member.segments;
    plan.rows = plan.lanes.rows = lane_rows(plan.segments);
    plan.joint.assign(at(plan.segments + 1), 0);
    plan.end_direction.setZero();
    for (int i = 0; i <= plan.segments; ++i) {
      const int node = member.nodes[at(i)], entry = entries_ + lane_slot(i, plan.rows);
      const bool met = entry_of_node_[at(node)] >= 0;
      plan.entry.push_back(entry);
      plan.diagonal.push_back(met ? 0 : mass_between(node, node));
      if (i > 0) plan.off.push_back(mass_between(member.nodes[at(i - 1)], node));
      if (!met) entry_of_node_[at(node)] = entry;
      if (i > 0 && i < plan.segments) continue;
      if (shared_of_node[at(node)] < 0) {
        shared_of_node[at(node)] = static_cast<int>(shared_.size());
        shared_.emplace_back();
        shared_.back().node = node;
        for (int c = 0; c < 3; ++c) shared_.back().held[c] = chain.fixed(c, node);
      }
      plan.shared[i == 0 ? 0 : 1] = shared_of_node[at(node)];
      shared_[at(shared_of_node[at(node)])].entries.push_back(entry);
    }
    for (int i = 1; i < plan.segments; ++i) {
      const InnerJoint& joint = chain.inner_joints[at(member.first_joint + i - 1)];
      plan.joint[at(i)] = in_plane_stiffness(chain, joint.springs, joint.segment[0]);
    }
    for (int end = 0; end < 2; ++end) {
      const int index = member.end_joint[at(end)];
      if (index < 0) continue;
      const EndJoint& joint = chain.end_joints[at(index)];
      const double stiffness = in_plane_stiffness(chain, joint.springs, joint.segment);
      plan.joint[at(end == 0 ? 0 : plan.segments)] = stiffness;
      plan.end_direction.col(end) = joint.directors.col(0);
      if (joint.rotation >= 0) {
        turning_[at(joint.rotation)].ends.push_back(
            {static_cast<int>(members_.size()), end, stiffness});
      }
    }
    set_lanes(member, plan);
    entries_ += kLanes * plan.rows;
    members_.push_back(std::move(plan));
  }
  for (int c = 0; c < D; ++c) direction_[c].assign(at(entries_), 0);
  inverse_length_.assign(at(entries_), 0);
  axial_force_.assign(at(entries_), 0);
}

// What a member's segments, joints and padding have, in lane order.
template <int D>
void MotionKernel<D>::set_lanes(const ChainMember& member, MemberPlan& plan) {
  LaneMember& lanes = plan.lanes;
  const std::size_t slots = at(kLanes * plan.rows);
  for (LaneVector* all :
       {&lanes.axial, &lanes.inverse_length, &lanes.inverse_square, &lanes.joint_before,
        &lanes.joint_behind, &lanes.fill[0], &lanes.fill[1], &lanes.fill[2]}) {
    all->assign(slots, 0);
  }
  lanes.pad.assign(slots, 1);
  for (int i = 0; i < plan.segments; ++i) {
    const Segment& segment = chain_->segments[at(member.first_segment + i)];
    plan.axial.push_back(segment.EA / segment.length);
    const std::size_t slot = at(plan.entry[at(i)] - plan.offset);
    lanes.axial[slot] = segment.EA;
    lanes.inverse_length[slot] = 1 / segment.length;
    lanes.inverse_square[slot] = 1 / (segment.length * segment.length);
    lanes.pad[slot] = 0;
    lanes.joint_before[slot] = plan.joint[at(i)];
    lanes.joint_behind[slot] = plan.joint[at(i + 1)];
  }
  for (int end = 0; end < 2; ++end) {
    for (int c = 0; c < D; ++c) {
      lanes.fill[c][at(plan.end_side(end) - plan.offset)] = plan.end_direction(c, end);
    }
  }
}

template <int D>
LaneScratch MotionKernel<D>::scratch(const MemberPlan& plan) {
  LaneScratch out;
  for (int c = 0; c < D; ++c) out.direction[c] = direction_[c].data() + plan.offset;
  out.inverse = inverse_length_.data() + plan.offset;
  out.tension = axial_force_.data() + plan.offset;
  return out;
}

template <int D>
void MotionKernel<D>::tangents(const double* positions) {
  for (const MemberPlan& plan : members_) {
    loops_->tangents(plan.lanes, entries_, positions + plan.offset, scratch(plan));
  }
}

// Turning nodes follow their members: the angle of least energy, and the node's side of its joints.
template <int D>
void MotionKernel<D>::turn_nodes() {
  if constexpr (D == 2) {
    for (Turning& node : turning_) {
      double cosine = node.spring, sine = 0;
      for (const auto& end : node.ends) {
        const MemberPlan& plan = members_[at(end.member)];
        const int s = plan.end_segment(end.end);
        const double tx = direction_[0][at(s)], ty = direction_[1][at(s)];
        const double dx = plan.end_direction(0, end.end), dy = plan.end_direction(1, end.end);
        cosine += end.stiffness * (tx * dx + ty * dy);
        sine += end.stiffness * (dx * ty - dy * tx);
      }
      double c = 1, s = 0;
      const double size = std::hypot(cosine, sine);
      if (!node.held && size > 0) c = cosine / size, s = sine / size;
      node.cosine = c;
      node.sine = s;
      for (const auto& end : node.ends) {
        const MemberPlan& plan = members_[at(end.member)];
        const int entry = plan.end_side(end.end);
        const double dx = plan.end_direction(0, end.end), dy = plan.end_direction(1, end.end);
        direction_[0][at(entry)] = c * dx - s * dy;
        direction_[1][at(entry)] = s * dx + c * dy;
      }
    }
  }
}

template <int D>
void MotionKernel<D>::acceleration(const double* positions, const double* external,
                                   double* acceleration) {
  tangents(positions);
  if (!turning_.empty()) turn_nodes();

  for (const MemberPlan& plan : members_) {
    loops_->forces(plan.lanes, entries_, scratch(plan), gravity_.data() + plan.offset,
                   acceleration + plan.offset);
  }
  if (external) {
    Map<VectorXd>(acceleration, size()) += Map<const VectorXd>(external, size());
  }
  if (springs_) {
    for (const SharedNode& node : shared_) {
      const int entry = node.entries[0];
      for (int c = 0; c < D; ++c) {
        acceleration[c * entries_ + entry] -=
            node.spring(c) * (positions[c * entries_ + entry] - node.anchor(c));
      }
    }
  }
  mass_.solve(acceleration);
}

template <int D>
VectorXd MotionKernel<D>::positions(const ChainState& state) const {
  VectorXd result(size());
  for (std::size_t m = 0; m < members_.size(); ++m) {
    const MemberPlan& plan = members_[m];
    const std::vector<int>& nodes = chain_->members[m].nodes;
    for (int c = 0; c < D; ++c) {
      // Padding stays where the last node begins.
      result.segment(c * entries_ + plan.offset, kLanes * plan.rows)
          .setConstant(state.position(c, nodes[at(plan.segments)]));
      for (int i = 0; i <= plan.segments; ++i) {
        result(c * entries_ + plan.entry[at(i)]) = state.position(c, nodes[at(i)]);
      }
    }
  }
  return result;
}

template <int D>
ChainState MotionKernel<D>::state(const Entries& positions) {
  ChainState result = drawn_state(*chain_);
  assembly_.advance(result, unknowns(positions - this->positions(result)), 1, result);
  if constexpr (D == 2) {
    tangents(positions.data());
    turn_nodes();
    for (std::size_t r = 0; r < turning_.size(); ++r) {
      const double c = turning_[r].cosine, s = turning_[r].sine;
      result.rotation[r] << c, -s, 0, s, c, 0, 0, 0, 1;
    }
  }
  return result;
}

template <int D>
VectorXd MotionKernel<D>::unknowns(const Entries& entries) const {
  const Numbering& numbering = assembly_.numbering();
  VectorXd result = VectorXd::Zero(numbering.size);
  for (int node = 0; node < chain_->nodes; ++node) {
    const int entry = entry_of_node_[at(node)];
    if (entry < 0) continue;
    for (int c = 0; c < D; ++c) {
      const int k = numbering.displacement(c, node);
      if (k >= 0) result(k) = entries(c * entries_ + entry);
    }
  }
  return result;
}

template <int D>
VectorXd MotionKernel<D>::entry_values(const VectorXd& unknowns) const {
  const Numbering& numbering = assembly_.numbering();
  VectorXd result = VectorXd::Zero(size());
  for (std::size_t m = 0; m < members_.size(); ++m) {
    for (int i = 0; i <= members_[m].segments; ++i) {
      const int node = chain_->members[m].nodes[at(i)];
      for (int c = 0; c < D; ++c) {
        const int k = numbering.displacement(c, node);
        if (k >= 0) result(c * entries_ + members_[m].entry[at(i)]) = unknowns(k);
      }
    }
  }
  return result;
}

template <int D>
VectorXd MotionKernel<D>::covector(const VectorXd& weights) const {
  VectorXd result = entry_values(weights);
  for (const SharedNode& node : shared_) {
    for (std::size_t k = 1; k < node.entries.size(); ++k) {
      for (int c = 0; c < D; ++c) result(c * entries_ + node.entries[k]) = 0;
    }
  }
  return result;
}

template <int D>
template <class Visit>
void MotionKernel<D>::each_segment(const Visit& visit) const {
  Index segment = 0;
  for (const MemberPlan& plan : members_) {
    for (int i = 0; i < plan.segments; ++i, ++segment) {
      for (int c = 0; c < D; ++c) {
        const int from = plan.entry[at(i)];
        visit(segment, c * entries_ + from, c * entries_ + plan.entry[at(i + 1)],
              direction_[c][at(from)]);
      }
    }
  }
}

template <int D>
void MotionKernel<D>::stretch(const double* velocities, VectorXd& rates) const {
  rates.setZero();
  each_segment([&](Index segment, int from, int to, double direction) {
    rates(segment) += direction * (velocities[to] - velocities[from]);
  });
}

template <int D>
void MotionKernel<D>::push(const float* thrusts, double* forces) const {
  each_segment([&](Index segment, int from, int to, double direction) {
    const double force = direction * thrusts[segment];
    forces[from] -= force;
    forces[to] += force;
  });
}

template <int D>
double MotionKernel<D>::axial_force(int segment, const double* positions) const {
  const Segment& s = chain_->segments[at(segment)];
  const int first = entry_of_node_[at(s.a)], second = entry_of_node_[at(s.b)];
  double square = 0;
  for (int c = 0; c < D; ++c) {
    const double e = positions[c * entries_ + second] - positions[c * entries_ + first];
    square += e * e;
  }
  return s.EA / s.length * (std::sqrt(square) - s.length);
}

template class MotionKernel<2>;
template class MotionKernel<3>;

}  // namespace rigfit::model
