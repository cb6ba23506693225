#include "model/motion_kernel.h"

#include <Eigen/Cholesky>
#include <cassert>
#include <cmath>

namespace rigfit::model {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

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
  slot_of_node_.assign(at(chain.nodes), -1);
  slot_of_segment_.assign(chain.segments.size(), -1);
  std::vector<int> shared_of_node(at(chain.nodes), -1);
  turning_.resize(chain.rotating_node.size());
  if constexpr (D == 2) {
    for (std::size_t r = 0; r < turning_.size(); ++r) {
      turning_[r].held = chain.rotation_fixed(2, static_cast<Eigen::Index>(r));
    }
  }

  int scratch = 0;
  for (const ChainMember& member : chain.members) {
    MemberPlan plan;
    plan.offset = slots_;
    plan.segments = member.segments;
    plan.scratch = scratch;
    scratch += plan.segments + 2;
    plan.diagonal.assign(at(plan.segments + 1), 0);
    plan.off.assign(at(plan.segments), 0);
    plan.joint.assign(at(plan.segments + 1), 0);
    plan.end_direction.setZero();
    for (int i = 0; i <= plan.segments; ++i) {
      const int node = member.nodes[at(i)], slot = slots_ + i;
      if (slot_of_node_[at(node)] < 0) slot_of_node_[at(node)] = slot;
      if (i > 0 && i < plan.segments) continue;
      if (shared_of_node[at(node)] < 0) {
        shared_of_node[at(node)] = static_cast<int>(shared_.size());
        shared_.emplace_back();
        shared_.back().node = node;
        for (int c = 0; c < 3; ++c) shared_.back().held[c] = chain.fixed(c, node);
      }
      plan.shared[i == 0 ? 0 : 1] = shared_of_node[at(node)];
      shared_[at(shared_of_node[at(node)])].slots.push_back(slot);
    }
    for (int i = 0; i < plan.segments; ++i) {
      const Segment& segment = chain.segments[at(member.first_segment + i)];
      slot_of_segment_[at(member.first_segment + i)] = slots_ + i;
      plan.axial.push_back(segment.EA / segment.length);
      plan.length.push_back(segment.length);
      const double own = segment.mass * (0.5 - segment.coupling);
      plan.diagonal[at(i)] += own;
      plan.diagonal[at(i + 1)] += own;
      plan.off[at(i)] += segment.mass * segment.coupling;
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
      plan.rotation[end] = joint.rotation;
      if (joint.rotation >= 0) {
        turning_[at(joint.rotation)].ends.push_back(
            {static_cast<int>(members_.size()), end, stiffness});
      }
    }
    slots_ += plan.segments + 1;
    members_.push_back(std::move(plan));
  }

  // Point masses, in the mass and in gravity (each node's share of what lies beside it).
  std::vector<double> weight(at(slots_), 0);
  for (const MemberPlan& plan : members_) {
    for (int i = 0; i <= plan.segments; ++i) {
      double sum = plan.diagonal[at(i)];
      if (i > 0) sum += plan.off[at(i - 1)];
      if (i < plan.segments) sum += plan.off[at(i)];
      weight[at(plan.offset + i)] = sum;
    }
  }
  for (const PointMass& mass : chain.masses) {
    const double f = mass.fraction;
    if (f == 0 || mass.member < 0) {
      const int node = mass.node[0];
      const int slot = slot_of_node_[at(node)];
      if (slot < 0) continue;
      weight[at(slot)] += mass.mass;
      for (MemberPlan& plan : members_) {
        if (slot >= plan.offset && slot <= plan.offset + plan.segments) {
          plan.diagonal[at(slot - plan.offset)] += mass.mass;
        }
      }
      continue;
    }
    for (const ChainMember& member : chain.members) {
      MemberPlan& plan = members_[at(static_cast<int>(&member - chain.members.data()))];
      for (int i = 0; i < plan.segments; ++i) {
        if (member.nodes[at(i)] != mass.node[0] || member.nodes[at(i + 1)] != mass.node[1]) {
          continue;
        }
        plan.diagonal[at(i)] += (1 - f) * (1 - f) * mass.mass;
        plan.diagonal[at(i + 1)] += f * f * mass.mass;
        plan.off[at(i)] += f * (1 - f) * mass.mass;
        weight[at(plan.offset + i)] += (1 - f) * mass.mass;
        weight[at(plan.offset + i + 1)] += f * mass.mass;
      }
    }
  }
  gravity_.assign(at(size()), 0);
  for (const MemberPlan& plan : members_) {
    for (int i = 1; i < plan.segments; ++i) {
      for (int c = 0; c < D; ++c) {
        gravity_[at(c * slots_ + plan.offset + i)] = weight[at(plan.offset + i)] * chain.gravity(c);
      }
    }
    for (const auto& [end, slot] : {std::pair{0, 0}, std::pair{1, plan.segments}}) {
      SharedNode& node = shared_[at(plan.shared[end])];
      node.mass += plan.diagonal[at(slot)];
      node.gravity += weight[at(plan.offset + slot)] * chain.gravity;
    }
  }
  for (const NodeSupport& support : chain.supports) {
    const int index = shared_of_node[at(support.node)];
    if (index >= 0) {
      shared_[at(index)].spring += support.translational;
      shared_[at(index)].anchor = chain.drawn.col(support.node);
    }
    if (support.rotation >= 0) turning_[at(support.rotation)].spring += support.rotational(2);
  }
  for (int c = 0; c < D; ++c) {
    direction_[c].assign(at(scratch), 0);
    force_[c].assign(at(scratch), 0);
  }
  inverse_length_.assign(at(scratch), 0);
  axial_force_.assign(at(scratch), 0);
  factor_mass();
}

template <int D>
void MotionKernel<D>::factor_mass() {
  for (MemberPlan& plan : members_) {
    const int n = plan.segments;
    plan.eliminate.assign(at(n + 1), 0);
    plan.inverse.assign(at(n + 1), 0);
    for (int i = 1; i < n; ++i) {
      double pivot = plan.diagonal[at(i)];
      if (i > 1) {
        plan.eliminate[at(i)] = plan.off[at(i - 1)] * plan.inverse[at(i - 1)];
        pivot -= plan.eliminate[at(i)] * plan.off[at(i - 1)];
      }
      plan.inverse[at(i)] = 1 / pivot;
    }
    const auto solved = [&](int row, double value) {
      std::vector<double> x(at(n + 1), 0);
      if (n < 2) return x;
      x[at(row)] = value;
      for (int i = 2; i < n; ++i) x[at(i)] -= plan.eliminate[at(i)] * x[at(i - 1)];
      for (int i = n - 1; i > 0; --i) {
        x[at(i)] *= plan.inverse[at(i)];
        if (i < n - 1) x[at(i)] -= plan.eliminate[at(i + 1)] * x[at(i + 1)];
      }
      return x;
    };
    plan.from_first = solved(1, plan.off.front());
    plan.from_last = solved(n - 1, plan.off.back());
  }
  // Schur complement of the nodes at members' ends, per component.
  for (int c = 0; c < D; ++c) {
    auto& free = shared_free_[at(c)];
    std::vector<int> row(shared_.size(), -1);
    for (std::size_t k = 0; k < shared_.size(); ++k) {
      if (shared_[k].held[c]) continue;
      row[k] = static_cast<int>(free.size());
      free.push_back(static_cast<int>(k));
    }
    const auto n = static_cast<Eigen::Index>(free.size());
    Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i) mass(i, i) = shared_[at(free[at(int(i))])].mass;
    for (const MemberPlan& plan : members_) {
      const int a = row[at(plan.shared[0])], b = row[at(plan.shared[1])], last = plan.segments - 1;
      if (plan.segments == 1) {
        if (a >= 0 && b >= 0) mass(a, b) += plan.off[0], mass(b, a) += plan.off[0];
        continue;
      }
      if (a >= 0) mass(a, a) -= plan.off.front() * plan.from_first[1];
      if (b >= 0) mass(b, b) -= plan.off.back() * plan.from_last[at(last)];
      if (a >= 0 && b >= 0) {
        const double coupling = plan.off.front() * plan.from_last[1];
        mass(a, b) -= coupling;
        mass(b, a) -= coupling;
      }
    }
    shared_inverse_[at(c)] = mass.llt().solve(Eigen::MatrixXd::Identity(n, n));
    reduced_.resize(std::max(reduced_.size(), static_cast<std::size_t>(2 * n)));
  }
}

template <int D>
void MotionKernel<D>::tangents(const double* positions) {
  for (const MemberPlan& plan : members_) {
    const int n = plan.segments;
    const double* axial = plan.axial.data();
    const double* length = plan.length.data();
    double* __restrict inverse = inverse_length_.data() + plan.scratch;
    double* __restrict tension = axial_force_.data() + plan.scratch;
    double* __restrict tx = direction_[0].data() + plan.scratch + 1;
    double* __restrict ty = direction_[1].data() + plan.scratch + 1;
    const double* x = positions + plan.offset;
    const double* y = x + slots_;
    if constexpr (D == 2) {
      for (int i = 0; i < n; ++i) {
        const double ex = x[i + 1] - x[i], ey = y[i + 1] - y[i];
        const double L = std::sqrt(ex * ex + ey * ey), r = 1 / L;
        tx[i] = ex * r;
        ty[i] = ey * r;
        inverse[i] = r;
        tension[i] = axial[i] * (L - length[i]);
      }
    } else {
      double* __restrict tz = direction_[D - 1].data() + plan.scratch + 1;
      const double* z = y + slots_;
      for (int i = 0; i < n; ++i) {
        const double ex = x[i + 1] - x[i], ey = y[i + 1] - y[i], ez = z[i + 1] - z[i];
        const double L = std::sqrt(ex * ex + ey * ey + ez * ez), r = 1 / L;
        tx[i] = ex * r;
        ty[i] = ey * r;
        tz[i] = ez * r;
        inverse[i] = r;
        tension[i] = axial[i] * (L - length[i]);
      }
    }
    for (int c = 0; c < D; ++c) {
      direction_[c][at(plan.scratch)] = plan.end_direction(c, 0);
      direction_[c][at(plan.scratch + n + 1)] = plan.end_direction(c, 1);
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
        const int slot = plan.scratch + (end.end == 0 ? 0 : plan.segments + 1);
        const double dx = plan.end_direction(0, end.end), dy = plan.end_direction(1, end.end);
        direction_[0][at(slot)] = c * dx - s * dy;
        direction_[1][at(slot)] = s * dx + c * dy;
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
    const int n = plan.segments;
    const double* joint = plan.joint.data();
    const double* inverse = inverse_length_.data() + plan.scratch;
    const double* tension = axial_force_.data() + plan.scratch;
    const double* tx = direction_[0].data() + plan.scratch;
    const double* ty = direction_[1].data() + plan.scratch;
    double* __restrict fx = force_[0].data() + plan.scratch;
    double* __restrict fy = force_[1].data() + plan.scratch;
    if constexpr (D == 2) {
      for (int i = 0; i < n; ++i) {
        const double gx = joint[i] * tx[i] + joint[i + 1] * tx[i + 2];
        const double gy = joint[i] * ty[i] + joint[i + 1] * ty[i + 2];
        const double along = tension[i] + (gx * tx[i + 1] + gy * ty[i + 1]) * inverse[i];
        fx[i] = along * tx[i + 1] - gx * inverse[i];
        fy[i] = along * ty[i + 1] - gy * inverse[i];
      }
    } else {
      const double* tz = direction_[D - 1].data() + plan.scratch;
      double* __restrict fz = force_[D - 1].data() + plan.scratch;
      for (int i = 0; i < n; ++i) {
        const double gx = joint[i] * tx[i] + joint[i + 1] * tx[i + 2];
        const double gy = joint[i] * ty[i] + joint[i + 1] * ty[i + 2];
        const double gz = joint[i] * tz[i] + joint[i + 1] * tz[i + 2];
        const double along =
            tension[i] + (gx * tx[i + 1] + gy * ty[i + 1] + gz * tz[i + 1]) * inverse[i];
        fx[i] = along * tx[i + 1] - gx * inverse[i];
        fy[i] = along * ty[i + 1] - gy * inverse[i];
        fz[i] = along * tz[i + 1] - gz * inverse[i];
      }
    }
    // Forces on the inner nodes, then the mass of the inner nodes alone: all components in one
    // pass, because each is a chain of dependent operations.
    const double *f[D], *weight[D], *outer[D];
    double* a[D];
    for (int c = 0; c < D; ++c) {
      f[c] = force_[c].data() + plan.scratch;
      weight[c] = gravity_.data() + c * slots_ + plan.offset;
      outer[c] = external ? external + c * slots_ + plan.offset : nullptr;
      a[c] = acceleration + c * slots_ + plan.offset;
      for (int i = 1; i < n; ++i) a[c][i] = f[c][i] - f[c][i - 1] + weight[c][i];
      if (external) {
        for (int i = 1; i < n; ++i) a[c][i] += outer[c][i];
      }
    }
    const double* eliminate = plan.eliminate.data();
    const double* inverse_pivot = plan.inverse.data();
    for (int i = 2; i < n; ++i) {
      for (int c = 0; c < D; ++c) a[c][i] -= eliminate[i] * a[c][i - 1];
    }
    if (n > 1) {
      for (int c = 0; c < D; ++c) a[c][n - 1] *= inverse_pivot[n - 1];
    }
    for (int i = n - 2; i > 0; --i) {
      for (int c = 0; c < D; ++c) {
        a[c][i] = a[c][i] * inverse_pivot[i] - eliminate[i + 1] * a[c][i + 1];
      }
    }
  }

  // The nodes at members' ends.
  for (int c = 0; c < D; ++c) {
    double* all = acceleration + c * slots_;
    const auto& free = shared_free_[at(c)];
    const int count = static_cast<int>(free.size());
    if (count == 0) {
      for (const MemberPlan& plan : members_) {
        all[plan.offset] = 0;
        all[plan.offset + plan.segments] = 0;
      }
      continue;
    }
    // Right-hand sides by shared node, kept in the first slot of each.
    for (int k : free) {
      const SharedNode& node = shared_[at(k)];
      double sum = node.gravity(c);
      for (int d = 0; d < D; ++d) {
        const double spring = node.spring(c, d);
        if (spring != 0) {
          sum -= spring * (positions[d * slots_ + node.slots[0]] - node.anchor(d));
        }
      }
      if (external) {
        for (int slot : node.slots) sum += external[c * slots_ + slot];
      }
      all[node.slots[0]] = sum;
    }
    for (const MemberPlan& plan : members_) {
      const double* f = force_[c].data() + plan.scratch;
      const int n = plan.segments;
      const SharedNode& first = shared_[at(plan.shared[0])];
      const SharedNode& last = shared_[at(plan.shared[1])];
      if (!first.held[c]) {
        all[first.slots[0]] += f[0] - (n > 1 ? plan.off.front() * all[plan.offset + 1] : 0);
      }
      if (!last.held[c]) {
        all[last.slots[0]] -= f[n - 1] + (n > 1 ? plan.off.back() * all[plan.offset + n - 1] : 0);
      }
    }
    double* rhs = reduced_.data();
    double* solution = rhs + count;
    for (int i = 0; i < count; ++i) {
      rhs[i] = all[shared_[at(free[at(i)])].slots[0]];
      solution[i] = 0;
    }
    const Eigen::MatrixXd& inverse = shared_inverse_[at(c)];
    for (int j = 0; j < count; ++j) {
      const double* column = inverse.data() + static_cast<std::ptrdiff_t>(j) * count;
      for (int i = 0; i < count; ++i) solution[i] += column[i] * rhs[j];
    }
    for (std::size_t k = 0; k < shared_.size(); ++k) {
      for (int slot : shared_[k].slots) all[slot] = 0;
    }
    for (int i = 0; i < count; ++i) {
      for (int slot : shared_[at(free[at(i)])].slots) all[slot] = solution[i];
    }
    for (const MemberPlan& plan : members_) {
      double* a = all + plan.offset;
      const int n = plan.segments;
      const double first = a[0], last = a[n];
      if (first == 0 && last == 0) continue;
      for (int i = 1; i < n; ++i) {
        a[i] -= plan.from_first[at(i)] * first + plan.from_last[at(i)] * last;
      }
    }
  }
}

template <int D>
double MotionKernel<D>::mass_product(const Eigen::VectorXd& x, const Eigen::VectorXd& y) const {
  double sum = 0;
  for (const MemberPlan& plan : members_) {
    for (int c = 0; c < D; ++c) {
      const double* a = x.data() + c * slots_ + plan.offset;
      const double* b = y.data() + c * slots_ + plan.offset;
      for (int i = 0; i <= plan.segments; ++i) sum += plan.diagonal[at(i)] * a[i] * b[i];
      for (int i = 0; i < plan.segments; ++i) {
        sum += plan.off[at(i)] * (a[i] * b[i + 1] + a[i + 1] * b[i]);
      }
    }
  }
  return sum;
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
        const int k = c * slots_ + plan.offset + i;
        sum -= gravity_[at(k)] * positions(k);
      }
    }
  }
  for (const SharedNode& node : shared_) {
    Eigen::Vector3d away = -node.anchor;
    for (int c = 0; c < D; ++c) {
      const double x = positions(c * slots_ + node.slots[0]);
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
        result(c * slots_ + members_[m].offset + i) = state.position(c, node);
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
        result.position(c, node) = positions(c * slots_ + members_[m].offset + i);
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
Eigen::VectorXd MotionKernel<D>::unknowns(const Eigen::VectorXd& slots,
                                          const Numbering& numbering) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(numbering.size);
  for (int node = 0; node < chain_->nodes; ++node) {
    const int slot = slot_of_node_[at(node)];
    if (slot < 0) continue;
    for (int c = 0; c < D; ++c) {
      const int k = numbering.displacement(c, node);
      if (k >= 0) result(k) = slots(c * slots_ + slot);
    }
  }
  return result;
}

template <int D>
Eigen::VectorXd MotionKernel<D>::slot_values(const Eigen::VectorXd& unknowns,
                                             const Numbering& numbering) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(size());
  for (std::size_t m = 0; m < members_.size(); ++m) {
    for (int i = 0; i <= members_[m].segments; ++i) {
      const int node = chain_->members[m].nodes[at(i)];
      for (int c = 0; c < D; ++c) {
        const int k = numbering.displacement(c, node);
        if (k >= 0) result(c * slots_ + members_[m].offset + i) = unknowns(k);
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
    const int slot = slot_of_node_[at(point.node[at(i)])];
    if (slot < 0) continue;
    for (int c = 0; c < D; ++c) {
      const double weight = point.weight[at(i)] * direction(c);
      if (weight == 0) continue;
      result.index.push_back(c * slots_ + slot);
      result.weight.push_back(weight);
    }
  }
  return result;
}

template <int D>
double MotionKernel<D>::axial_force(int segment, const double* positions) const {
  const int slot = slot_of_segment_[at(segment)];
  double square = 0;
  for (int c = 0; c < D; ++c) {
    const double e = positions[c * slots_ + slot + 1] - positions[c * slots_ + slot];
    square += e * e;
  }
  const Segment& s = chain_->segments[at(segment)];
  return s.EA / s.length * (std::sqrt(square) - s.length);
}

template class MotionKernel<2>;
template class MotionKernel<3>;

}  // namespace rigfit::model
