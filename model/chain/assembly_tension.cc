// How the tension of cables whose unstretched length is sought goes with the unknowns and with that
// length.
#include "model/algebra/numbers.h"
#include "model/chain/assembly.h"
#include "model/chain/assembly_scatter.h"

namespace rigfit::model {

void Assembly::length_derivative(const ChainState& state, int index,
                                 Ref<VectorXd> derivative) const {
  derivative.setZero();
  // Axial force EA (|e| / l - 1): -EA |e| / l^2 by l = L / n; joints go with 1 / L, gravity with L.
  const ChainMember& member = chain_->members[at(index)];
  const double by_length = 1 / member.unstretched_length;
  ForceSink sink{{}, derivative.data()};
  Scatter<ForceSink> scatter(*chain_, numbering_, sink);
  for (int i = 0; i < member.segments; ++i) {
    const int k = member.first_segment + i;
    const Segment& s = chain_->segments[at(k)];
    const Directed here = directed(*chain_, state, k);
    const Vector3d t = here.directors.col(0);
    scatter.edge_force(s, -s.EA * here.length / s.length * by_length * t);
    const Vector3d weight = -s.mass / 2 * by_length * chain_->gravity;
    scatter.node_force(s.a, weight);
    scatter.node_force(s.b, weight);
  }
  member_joints(*chain_, state, member, -by_length, scatter, sink);
}

double Assembly::tension(const ChainState& state, int member) const {
  VectorXd unused;
  double by_length = 0;
  return tension_gradient(state, member, unused, by_length);
}

double Assembly::tension_gradient(const ChainState& state, int index, Ref<VectorXd> gradient,
                                  double& by_length) const {
  const ChainMember& member = chain_->members[at(index)];
  const Vector3d h = member.tension_direction;
  const int middle = member.segment_at(0.5);
  const int k = member.first_segment + middle;
  const Segment& s = chain_->segments[at(k)];
  const Directed here = directed(*chain_, state, k);
  const Vector3d t = here.directors.col(0);
  const double force = s.EA * (here.length / s.length - 1);
  // The weight between the segment's middle and the member's.
  const double from = member.places[at(middle)], to = member.places[at(middle + 1)];
  const double between = s.mass * ((from + to) / 2 - 0.5) / (to - from) * chain_->gravity.dot(h);
  double tension = force * t.dot(h) + between;
  by_length = (between - s.EA * here.length / s.length * t.dot(h)) / member.unstretched_length;
  // d (h . internal force) / de of the segment and of its neighbours.
  Vector3d own =
      h * (force / here.length) + t * (t.dot(h) * (s.EA / s.length - force / here.length));
  const bool wanted = gradient.size() == size();
  gradient.setZero();
  ForceSink sink{{}, gradient.data()};
  Scatter<ForceSink> scatter(*chain_, numbering_, sink);
  for (int side = 0; side < 2; ++side) {
    const int joint_index = middle - 1 + side;  // inner joint before, after
    if (joint_index < 0 || joint_index + 1 >= member.segments) continue;
    const InnerJoint& joint = chain_->inner_joints[at(member.first_joint + joint_index)];
    const int other = side == 0 ? k - 1 : k + 1;
    const Directed there = directed(*chain_, state, other);
    const RotationDerivatives d = joint_derivatives(
        there.directors, here.directors,
        director_weights(joint.springs.about_1, joint.springs.about_2, joint.springs.torsion));
    const auto jb = segment_rotation(here);
    const auto ja = segment_rotation(there);
    const double shear = (jb.transpose() * d.gradient_b).head<3>().dot(h);
    tension += shear;
    by_length -= shear / member.unstretched_length;
    if (!wanted) continue;
    Matrix4 bb = jb.transpose() * d.same * jb;
    add_second_order(d.gradient_b, here, bb);
    const Matrix4 ab = ja.transpose() * d.cross * jb;
    own += bb.topLeftCorner<3, 3>() * h;
    scatter.single_force(numbering_.twist[k], bb.bottomLeftCorner<1, 3>().dot(h.transpose()));
    scatter.edge_force(chain_->segments[at(other)], ab.topLeftCorner<3, 3>() * h);
    scatter.single_force(numbering_.twist[other], ab.bottomLeftCorner<1, 3>().dot(h.transpose()));
  }
  if (wanted) scatter.edge_force(s, own);
  return tension;
}

}  // namespace rigfit::model
