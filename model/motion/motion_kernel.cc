#include "model/motion/motion_kernel.h"

#include <cassert>
#include <cmath>

#include "model/chain/index.h"
#include "model/motion/vector_loops.h"

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
  return !chain.torsion && chain.rotating_node.empty();
}

template <int D>
MotionKernel<D>::MotionKernel(const Chain& chain) : chain_(&chain) {
  assert(kernel_supports(chain, D));
  entry_of_node_.assign(at(chain.nodes), -1);
  segment_entries_.resize(chain.segments.size());
  turning_.resize(chain.rotating_node.size());
  if constexpr (D == 2) {
    for (std::size_t r = 0; r < turning_.size(); ++r) {
      turning_[r].held = chain.rotation_fixed(2, static_cast<Eigen::Index>(r));
    }
  }
  std::vector<typename NodeMass<D>::Member> masses;
  make_members(masses);
  add_masses(masses);
  for (const NodeSupport& support : chain.supports) {
    for (SharedNode& node : shared_) {
      if (node.node != support.node) continue;
      node.spring += support.translational;
      springs_ = true;
      node.anchor = chain.drawn.col(support.node);
    }
    if (support.rotation >= 0) turning_[at(support.rotation)].spring += support.rotational(2);
  }
  std::vector<typename NodeMass<D>::Shared> shared;
  for (SharedNode& node : shared_) {
    shared.push_back({node.entries, {node.held[0], node.held[1], node.held[2]}});
    for (int c = 0; c < D; ++c) node.free = node.free || !node.held[c];
  }
  mass_ = NodeMass<D>(std::move(masses), std::move(shared), entries_);
}

template <int D>
void MotionKernel<D>::make_members(std::vector<typename NodeMass<D>::Member>& masses) {
  const Chain& chain = *chain_;
  std::vector<int> shared_of_node(at(chain.nodes), -1);
  for (const ChainMember& member : chain.members) {
    MemberPlan plan;
    typename NodeMass<D>::Member mass;
    plan.offset = mass.offset = entries_;
    plan.segments = mass.segments = member.segments;
    plan.rows = lane_rows(plan.segments);
    mass.diagonal.assign(at(plan.segments + 1), 0);
    mass.off.assign(at(plan.segments), 0);
    plan.joint.assign(at(plan.segments + 1), 0);
    plan.end_direction.setZero();
    for (int i = 0; i <= plan.segments; ++i) {
      const int node = member.nodes[at(i)], entry = entries_ + lane_slot(i, plan.rows);
      plan.entry.push_back(entry);
      if (entry_of_node_[at(node)] < 0) entry_of_node_[at(node)] = entry;
      if (i > 0 && i < plan.segments) continue;
      if (shared_of_node[at(node)] < 0) {
        shared_of_node[at(node)] = static_cast<int>(shared_.size());
        shared_.emplace_back();
        shared_.back().node = node;
        for (int c = 0; c < 3; ++c) shared_.back().held[c] = chain.fixed(c, node);
      }
      mass.shared[i == 0 ? 0 : 1] = shared_of_node[at(node)];
      shared_[at(shared_of_node[at(node)])].entries.push_back(entry);
    }
    for (int i = 0; i < plan.segments; ++i) {
      const Segment& segment = chain.segments[at(member.first_segment + i)];
      segment_entries_[at(member.first_segment + i)] = {plan.entry[at(i)], plan.entry[at(i + 1)]};
      plan.axial.push_back(segment.EA / segment.length);
      const double own = segment.mass * (0.5 - segment.coupling);
      mass.diagonal[at(i)] += own;
      mass.diagonal[at(i + 1)] += own;
      mass.off[at(i)] += segment.mass * segment.coupling;
    }
    mass.axial = plan.axial;
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
    set_lanes(plan);
    for (int i = 0; i < plan.segments; ++i) {
      const Segment& segment = chain.segments[at(member.first_segment + i)];
      const std::size_t slot = at(plan.entry[at(i)] - plan.offset);
      plan.lane_axial[slot] = segment.EA;
      plan.inverse_length[slot] = 1 / segment.length;
      plan.inverse_square[slot] = 1 / (segment.length * segment.length);
    }
    entries_ += kLanes * plan.rows;
    members_.push_back(std::move(plan));
    masses.push_back(std::move(mass));
  }
  for (int c = 0; c < D; ++c) direction_[c].assign(at(entries_), 0);
  inverse_length_.assign(at(entries_), 0);
  axial_force_.assign(at(entries_), 0);
}

// A member's joints and padding in lane order, room for what else its segments have.
template <int D>
void MotionKernel<D>::set_lanes(MemberPlan& plan) const {
  const std::size_t slots = at(kLanes * plan.rows);
  for (LaneVector* all : {&plan.lane_axial, &plan.inverse_length, &plan.inverse_square,
                          &plan.joint_before, &plan.joint_behind}) {
    all->assign(slots, 0);
  }
  plan.pad.assign(slots, 1);
  for (int i = 0; i < plan.segments; ++i) {
    const std::size_t slot = at(plan.entry[at(i)] - plan.offset);
    plan.pad[slot] = 0;
    plan.joint_before[slot] = plan.joint[at(i)];
    plan.joint_behind[slot] = plan.joint[at(i + 1)];
  }
  for (int c = 0; c < D; ++c) {
    plan.fill[c].assign(slots, 0);
    for (int end = 0; end < 2; ++end) {
      plan.fill[c][at(plan.end_side(end) - plan.offset)] = plan.end_direction(c, end);
    }
  }
}

// Point masses, in the mass and in gravity (each node's share of what lies beside it).
template <int D>
void MotionKernel<D>::add_masses(std::vector<typename NodeMass<D>::Member>& masses) {
  const Chain& chain = *chain_;
  std::vector<double> weight(at(entries_), 0);
  for (const auto& member : masses) {
    for (int i = 0; i <= member.segments; ++i) {
      double sum = member.diagonal[at(i)];
      if (i > 0) sum += member.off[at(i - 1)];
      if (i < member.segments) sum += member.off[at(i)];
      weight[at(member.entry(i))] = sum;
    }
  }
  for (const PointMass& mass : chain.masses) {
    const double f = mass.fraction;
    if (f == 0 || mass.member < 0) {
      const int entry = entry_of_node_[at(mass.node[0])];
      if (entry < 0) continue;
      weight[at(entry)] += mass.mass;
      for (auto& member : masses) {
        for (int i = 0; i <= member.segments; ++i) {
          if (entry == member.entry(i)) member.diagonal[at(i)] += mass.mass;
        }
      }
      continue;
    }
    for (std::size_t m = 0; m < masses.size(); ++m) {
      const ChainMember& place = chain.members[m];
      auto& member = masses[m];
      for (int i = 0; i < member.segments; ++i) {
        if (place.nodes[at(i)] != mass.node[0] || place.nodes[at(i + 1)] != mass.node[1]) continue;
        member.diagonal[at(i)] += (1 - f) * (1 - f) * mass.mass;
        member.diagonal[at(i + 1)] += f * f * mass.mass;
        member.off[at(i)] += f * (1 - f) * mass.mass;
        weight[at(member.entry(i))] += (1 - f) * mass.mass;
        weight[at(member.entry(i + 1))] += f * mass.mass;
      }
    }
  }
  gravity_.assign(at(size()), 0);
  for (const MemberPlan& plan : members_) {
    for (const int entry : plan.entry) {
      for (int c = 0; c < D; ++c) {
        gravity_[at(c * entries_ + entry)] = weight[at(entry)] * chain.gravity(c);
      }
    }
  }
  for (const SharedNode& node : shared_) {
    for (std::size_t k = 1; k < node.entries.size(); ++k) {
      for (int c = 0; c < D; ++c) {
        double& own = gravity_[at(c * entries_ + node.entries[k])];
        gravity_[at(c * entries_ + node.entries[0])] += own;
        own = 0;
      }
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
    loops_->tangents(plan.lanes(), entries_, positions + plan.offset, scratch(plan));
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
    loops_->forces(plan.lanes(), entries_, scratch(plan), gravity_.data() + plan.offset,
                   acceleration + plan.offset);
  }
  if (external) add_multiple(size(), acceleration, 1, external, acceleration);
  if (springs_) {
    for (const SharedNode& node : shared_) {
      const int entry = node.entries[0];
      for (int c = 0; c < D; ++c) {
        for (int d = 0; d < D; ++d) {
          acceleration[c * entries_ + entry] -=
              node.spring(c, d) * (positions[d * entries_ + entry] - node.anchor(d));
        }
      }
    }
  }
  mass_.solve(acceleration);
}

template <int D>
double MotionKernel<D>::potential(const Entries& positions) {
  tangents(positions.data());
  turn_nodes();
  double sum = 0;
  for (const MemberPlan& plan : members_) {
    for (int i = 0; i < plan.segments; ++i) {
      const double N = axial_force_[at(plan.entry[at(i)])];
      if (plan.axial[at(i)] > 0) sum += N * N / (2 * plan.axial[at(i)]);
    }
    for (int i = 0; i <= plan.segments; ++i) {
      const int before = i > 0 ? plan.entry[at(i - 1)] : plan.end_side(0);
      const int behind = plan.entry[at(i)];  // that of the last node: the end's side
      double square = 0;                     // 1 - t.u = |t - u|^2 / 2, without cancellation
      for (int c = 0; c < D; ++c) {
        const double difference = direction_[c][at(behind)] - direction_[c][at(before)];
        square += difference * difference;
      }
      sum += plan.joint[at(i)] * square / 2;
    }
  }
  for (int i = 0; i < size(); ++i) sum -= gravity_[at(i)] * positions(i);
  for (const SharedNode& node : shared_) {
    Eigen::Vector3d away = -node.anchor;
    for (int c = 0; c < D; ++c) away(c) += positions(c * entries_ + node.entries[0]);
    if constexpr (D == 2) away(2) = 0;
    sum += away.dot(node.spring * away) / 2;
  }
  for (const Turning& node : turning_) sum += node.spring * (1 - node.cosine);
  return sum;
}

template <int D>
Eigen::VectorXd MotionKernel<D>::positions(const ChainState& state) const {
  Eigen::VectorXd result(size());
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
ChainState MotionKernel<D>::state(const Entries& positions) const {
  ChainState result = drawn_state(*chain_);
  for (std::size_t m = 0; m < members_.size(); ++m) {
    for (int i = 0; i <= members_[m].segments; ++i) {
      const int node = chain_->members[m].nodes[at(i)];
      for (int c = 0; c < D; ++c) {
        result.position(c, node) = positions(c * entries_ + members_[m].entry[at(i)]);
      }
    }
  }
  if constexpr (D == 2) {
    MotionKernel copy = *this;
    copy.tangents(positions.data());
    copy.turn_nodes();
    for (std::size_t r = 0; r < turning_.size(); ++r) {
      const double c = copy.turning_[r].cosine, s = copy.turning_[r].sine;
      result.rotation[r] << c, -s, 0, s, c, 0, 0, 0, 1;
    }
    // Frames of an in-plane motion stay as drawn (normal to the plane) or turn with the tangent.
    for (const Segment& segment : chain_->segments) {
      if (segment.frame < 0) continue;
      const Eigen::Vector3d drawn = chain_->drawn_director.col(segment.frame);
      if (std::abs(drawn(2)) > 0.5) continue;
      const Eigen::Vector3d t =
          (result.position.col(segment.b) - result.position.col(segment.a)).normalized();
      const Eigen::Vector3d t0 =
          (chain_->drawn.col(segment.b) - chain_->drawn.col(segment.a)).normalized();
      const double side = t0(0) * drawn(1) - t0(1) * drawn(0);
      result.director.col(segment.frame) =
          std::copysign(1.0, side) * Eigen::Vector3d(-t(1), t(0), 0);
    }
  }
  return result;
}

template <int D>
Eigen::VectorXd MotionKernel<D>::unknowns(const Entries& entries,
                                          const Numbering& numbering) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(numbering.size);
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
Eigen::VectorXd MotionKernel<D>::entry_values(const Eigen::VectorXd& unknowns,
                                              const Numbering& numbering) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(size());
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
typename MotionKernel<D>::Row MotionKernel<D>::row(const ChainPoint& point,
                                                   const Eigen::Vector3d& direction) const {
  Row result;
  for (int i = 0; i < point.count; ++i) {
    const int entry = entry_of_node_[at(point.node[at(i)])];
    if (entry < 0) continue;
    for (int c = 0; c < D; ++c) {
      const double weight = point.weight[at(i)] * direction(c);
      if (weight == 0) continue;
      result.index.push_back(c * entries_ + entry);
      result.weight.push_back(weight);
    }
  }
  return result;
}

template <int D>
double MotionKernel<D>::axial_force(int segment, const double* positions) const {
  const std::array<int, 2>& entry = segment_entries_[at(segment)];
  double square = 0;
  for (int c = 0; c < D; ++c) {
    const double e = positions[c * entries_ + entry[1]] - positions[c * entries_ + entry[0]];
    square += e * e;
  }
  const Segment& s = chain_->segments[at(segment)];
  return s.EA / s.length * (std::sqrt(square) - s.length);
}

template class MotionKernel<2>;
template class MotionKernel<3>;

}  // namespace rigfit::model
