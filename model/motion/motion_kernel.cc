#include "model/motion/motion_kernel.h"

#include <cassert>
#include <cmath>

#include "model/chain/index.h"

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
  entry_of_segment_.assign(chain.segments.size(), -1);
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
  int scratch = 0;
  for (const ChainMember& member : chain.members) {
    MemberPlan plan;
    typename NodeMass<D>::Member mass;
    plan.offset = mass.offset = entries_;
    plan.segments = mass.segments = member.segments;
    plan.scratch = scratch;
    scratch += plan.segments + 2;
    mass.diagonal.assign(at(plan.segments + 1), 0);
    mass.off.assign(at(plan.segments), 0);
    plan.joint.assign(at(plan.segments + 1), 0);
    plan.end_direction.setZero();
    for (int i = 0; i <= plan.segments; ++i) {
      const int node = member.nodes[at(i)], entry = entries_ + i;
      if (entry_of_node_[at(node)] < 0) entry_of_node_[at(node)] = entry;
      if (i > 0 && i < plan.segments) continue;
      if (shared_of_node[at(node)] < 0) {
        shared_of_node[at(node)] = static_cast<int>(shared_.size());
        shared_.emplace_back();
        shared_.back().node = node;
        for (int c = 0; c < 3; ++c) shared_.back().held[c] = chain.fixed(c, node);
      }
      plan.shared[i == 0 ? 0 : 1] = mass.shared[i == 0 ? 0 : 1] = shared_of_node[at(node)];
      shared_[at(shared_of_node[at(node)])].entries.push_back(entry);
    }
    for (int i = 0; i < plan.segments; ++i) {
      const Segment& segment = chain.segments[at(member.first_segment + i)];
      entry_of_segment_[at(member.first_segment + i)] = entries_ + i;
      plan.axial.push_back(segment.EA / segment.length);
      plan.length.push_back(segment.length);
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
      plan.rotation[end] = joint.rotation;
      if (joint.rotation >= 0) {
        turning_[at(joint.rotation)].ends.push_back(
            {static_cast<int>(members_.size()), end, stiffness});
      }
    }
    entries_ += plan.segments + 1;
    members_.push_back(std::move(plan));
    masses.push_back(std::move(mass));
  }
  for (int c = 0; c < D; ++c) {
    direction_[c].assign(at(scratch), 0);
    force_[c].assign(at(scratch), 0);
  }
  inverse_length_.assign(at(scratch), 0);
  axial_force_.assign(at(scratch), 0);
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
      weight[at(member.offset + i)] = sum;
    }
  }
  for (const PointMass& mass : chain.masses) {
    const double f = mass.fraction;
    if (f == 0 || mass.member < 0) {
      const int entry = entry_of_node_[at(mass.node[0])];
      if (entry < 0) continue;
      weight[at(entry)] += mass.mass;
      for (auto& member : masses) {
        if (entry >= member.offset && entry <= member.offset + member.segments) {
          member.diagonal[at(entry - member.offset)] += mass.mass;
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
        weight[at(member.offset + i)] += (1 - f) * mass.mass;
        weight[at(member.offset + i + 1)] += f * mass.mass;
      }
    }
  }
  gravity_.assign(at(size()), 0);
  for (const MemberPlan& plan : members_) {
    for (int i = 1; i < plan.segments; ++i) {
      for (int c = 0; c < D; ++c) {
        gravity_[at(c * entries_ + plan.offset + i)] =
            weight[at(plan.offset + i)] * chain.gravity(c);
      }
    }
    for (const auto& [end, entry] : {std::pair{0, 0}, std::pair{1, plan.segments}}) {
      shared_[at(plan.shared[end])].gravity += weight[at(plan.offset + entry)] * chain.gravity;
    }
  }
}

template <int D>
void MotionKernel<D>::tangents(const double* positions) {
  for (const MemberPlan& plan : members_) {
    const int n = plan.segments;
    double* inverse = inverse_length_.data() + plan.scratch;
    double* tension = axial_force_.data() + plan.scratch;
    const double* x = positions + plan.offset;
    double* t[D];
    for (int c = 0; c < D; ++c) {
      t[c] = direction_[c].data() + plan.scratch;
      t[c][0] = plan.end_direction(c, 0);
      t[c][n + 1] = plan.end_direction(c, 1);
    }
    if constexpr (D == 2) {
      segment_tangents(n, x, x + entries_, plan.axial.data(), plan.length.data(), t[0], t[1],
                       inverse, tension);
    } else {
      segment_tangents(n, x, x + entries_, x + 2 * entries_, plan.axial.data(), plan.length.data(),
                       t[0], t[1], t[2], inverse, tension);
    }
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
        const int s = plan.scratch + (end.end == 0 ? 1 : plan.segments);
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
        const int entry = plan.scratch + (end.end == 0 ? 0 : plan.segments + 1);
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

  // Forces on the inner nodes.
  for (const MemberPlan& plan : members_) {
    const int n = plan.segments;
    const double* joint = plan.joint.data();
    const double* inverse = inverse_length_.data() + plan.scratch;
    const double* tension = axial_force_.data() + plan.scratch;
    const double* t[D];
    double* f[D];
    for (int c = 0; c < D; ++c) {
      t[c] = direction_[c].data() + plan.scratch;
      f[c] = force_[c].data() + plan.scratch;
    }
    if constexpr (D == 2) {
      segment_forces(n, joint, inverse, tension, t[0], t[1], f[0], f[1]);
    } else {
      segment_forces(n, joint, inverse, tension, t[0], t[1], t[2], f[0], f[1], f[2]);
    }
    for (int c = 0; c < D; ++c) {
      const int first = c * entries_ + plan.offset;
      node_forces(n, f[c], gravity_.data() + first, acceleration + first);
      if (!external) continue;
      for (int i = 1; i < n; ++i) acceleration[first + i] += external[first + i];
    }
  }
  // And on the nodes at members' ends, in the first entry of each.
  for (const SharedNode& node : shared_) {
    if (!node.free) continue;
    for (int c = 0; c < D; ++c) {
      double sum = node.gravity(c);
      for (int d = 0; d < D; ++d) {
        const double spring = node.spring(c, d);
        if (spring != 0) {
          sum -= spring * (positions[d * entries_ + node.entries[0]] - node.anchor(d));
        }
      }
      if (external) {
        for (int entry : node.entries) sum += external[c * entries_ + entry];
      }
      acceleration[c * entries_ + node.entries[0]] = sum;
    }
  }
  for (const MemberPlan& plan : members_) {
    const SharedNode& first = shared_[at(plan.shared[0])];
    const SharedNode& last = shared_[at(plan.shared[1])];
    for (int c = 0; c < D; ++c) {
      const double* f = force_[c].data() + plan.scratch;
      if (first.free) acceleration[c * entries_ + first.entries[0]] += f[0];
      if (last.free) acceleration[c * entries_ + last.entries[0]] -= f[plan.segments - 1];
    }
  }
  mass_.solve(acceleration);
}

template <int D>
double MotionKernel<D>::potential(const Eigen::VectorXd& positions) {
  tangents(positions.data());
  turn_nodes();
  double sum = 0;
  for (const MemberPlan& plan : members_) {
    for (int i = 0; i < plan.segments; ++i) {
      const double N = axial_force_[at(plan.scratch + i)];
      if (plan.axial[at(i)] > 0) sum += N * N / (2 * plan.axial[at(i)]);
    }
    for (int i = 0; i <= plan.segments; ++i) {
      double square = 0;  // 1 - t.u = |t - u|^2 / 2, without cancellation
      for (int c = 0; c < D; ++c) {
        const double difference =
            direction_[c][at(plan.scratch + i + 1)] - direction_[c][at(plan.scratch + i)];
        square += difference * difference;
      }
      sum += plan.joint[at(i)] * square / 2;
    }
    for (int i = 1; i < plan.segments; ++i) {
      for (int c = 0; c < D; ++c) {
        const int k = c * entries_ + plan.offset + i;
        sum -= gravity_[at(k)] * positions(k);
      }
    }
  }
  for (const SharedNode& node : shared_) {
    Eigen::Vector3d away = -node.anchor;
    for (int c = 0; c < D; ++c) {
      const double x = positions(c * entries_ + node.entries[0]);
      sum -= node.gravity(c) * x;
      away(c) += x;
    }
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
    for (int i = 0; i <= members_[m].segments; ++i) {
      const int node = chain_->members[m].nodes[at(i)];
      for (int c = 0; c < D; ++c) {
        result(c * entries_ + members_[m].offset + i) = state.position(c, node);
      }
    }
  }
  return result;
}

template <int D>
ChainState MotionKernel<D>::state(const Eigen::VectorXd& positions) const {
  ChainState result = drawn_state(*chain_);
  for (std::size_t m = 0; m < members_.size(); ++m) {
    for (int i = 0; i <= members_[m].segments; ++i) {
      const int node = chain_->members[m].nodes[at(i)];
      for (int c = 0; c < D; ++c) {
        result.position(c, node) = positions(c * entries_ + members_[m].offset + i);
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
Eigen::VectorXd MotionKernel<D>::unknowns(const Eigen::VectorXd& entries,
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
        if (k >= 0) result(c * entries_ + members_[m].offset + i) = unknowns(k);
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
  const int entry = entry_of_segment_[at(segment)];
  double square = 0;
  for (int c = 0; c < D; ++c) {
    const double e = positions[c * entries_ + entry + 1] - positions[c * entries_ + entry];
    square += e * e;
  }
  const Segment& s = chain_->segments[at(segment)];
  return s.EA / s.length * (std::sqrt(square) - s.length);
}

template class MotionKernel<2>;
template class MotionKernel<3>;

}  // namespace rigfit::model
