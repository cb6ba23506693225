#include "model/chain/chain.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "model/chain/segment_lumping.h"
#include "model/scene/actual_state.h"
#include "model/scene/model_reduction.h"

namespace rigfit::model {
namespace {

constexpr int kDefaultSegments = 30;        // the paper's
constexpr double kClampedAxial = 14.0 / 9;  // (1/12 + 5/108) / (1/12), segment_lumping.h

/// Share of a segment's mass that couples its nodes.
double mass_coupling(RotaryInertia lumping, bool cable) {
  if (!cable || lumping == RotaryInertia::rigid_rod) return 1.0 / 6;
  return lumping == RotaryInertia::accurate ? 1.0 / 12 : 0;
}

double power(double x, int n) {
  double y = 1;
  for (int k = 0; k < n; ++k) y *= x;
  return y;
}

/// The segment-wise numbers of a member of unstretched length L, tapered, cut at `places`.
class Sections {
 public:
  /// `even`: segments alike, to the last digit.
  Sections(const Member& member, const std::vector<double>& places, bool even, double length)
      : member_(member), places_(places), even_(even), length_(length) {}

  [[nodiscard]] std::size_t segments() const { return places_.size() - 1; }
  double diameter(double s) const { return 1 + (member_.taper - 1) * s; }  // over the first
  double segment_length(std::size_t i) const {
    return even_ ? length_ / static_cast<double>(segments())
                 : length_ * (places_[i + 1] - places_[i]);
  }
  double segment_mass(std::size_t i) const {
    const double d0 = diameter(places_[i]), d1 = diameter(places_[i + 1]);
    return member_.mass_per_length * segment_length(i) * (d0 * d0 + d0 * d1 + d1 * d1) / 3;
  }
  double EA(std::size_t i) const { return member_.EA * power(diameter(middle(i)), 2); }
  double polar(std::size_t i) const {
    return member_.polar_inertia * segment_length(i) * power(diameter(middle(i)), 4);
  }
  /// Springs of the joint before segment i, or at the far end. `s` (0..1): its place; `flexibility`
  /// in l / EI there; torsion acts over `share` segments; `axial`: axial force of a beam, N
  /// (segment_lumping.h).
  JointSprings springs(std::size_t i, double s, double flexibility, double share, bool framed,
                       double axial) const {
    const double before = segment_length(i > 0 ? i - 1 : 0);
    const double after = segment_length(std::min(i, segments() - 1));
    const double l = 0.5 * (before + after);
    const double f = power(diameter(s), 4) / l;
    const double stiffened = -axial * (before * before + after * after) / (24 * l);
    const auto bent = [&](double EI) {
      return EI > 0 ? std::max(EI * f + stiffened, 0.5 * EI * f) / flexibility : 0;
    };
    JointSprings springs;
    springs.about_1 = bent(member_.EI[0]);
    springs.about_2 = bent(member_.EI[1]);
    springs.torsion = framed ? member_.GJ * f / share : 0;
    springs.bending_damping = member_.damping.bending / (flexibility * l);
    springs.torsion_damping = framed ? member_.damping.torsion / (share * l) : 0;
    return springs;
  }
  /// T l^2 / EI of the softer bending at an end.
  double layers(double tension, std::size_t end) const {
    const double EI = std::min(member_.EI[0], member_.EI[1]) * power(diameter(double(end)), 4);
    const double l = segment_length(end == 0 ? 0 : segments() - 1);
    if (!(tension > 0)) return 0;
    return EI > 0 ? tension * l * l / EI : std::numeric_limits<double>::infinity();
  }

 private:
  double middle(std::size_t i) const { return 0.5 * (places_[i] + places_[i + 1]); }

  const Member& member_;
  const std::vector<double>& places_;
  bool even_;
  double length_;
};

/// Flexibilities of all joints of a member, ends included, in l / EI (segment_lumping.h).
std::vector<double> joint_flexibilities(const Sections& sections, double tension,
                                        RotaryInertia lumping, const std::array<bool, 2>& bent) {
  const std::size_t n = sections.segments();
  std::vector<double> out(n + 1, 1.0);
  out.front() = out.back() = ClampFlexibility{}.end;
  if (lumping != RotaryInertia::accurate) return out;
  std::array<ClampFlexibility, 2> clamp;
  for (std::size_t e = 0; e < 2; ++e) {
    clamp[e] = clamp_flexibility(sections.layers(tension, e));
    out[e == 0 ? 0 : n] = clamp[e].end;
  }
  for (std::size_t e = 0; e < 2; ++e) {
    if (!bent[e]) continue;
    out[e == 0 ? 1 : n - 1] += clamp[e].next;
    out[e == 0 ? 2 : n - 2] += clamp[e].second;
  }
  return out;
}

ChainPoint point_on(const ChainMember& member, double position) {
  ChainPoint point;
  const std::vector<double>& places = member.places;
  const double s = std::clamp(position, 0.0, 1.0);
  const int segment = member.segment_at(s);
  point.segment = member.first_segment + segment;
  const double length = places[at(segment + 1)] - places[at(segment)];
  for (const int node : {segment, segment + 1}) {
    if (std::abs(s - places[at(node)]) >= 1e-9 * length) continue;
    return {{member.nodes[at(node)]}, {1}, 1, point.segment};
  }
  point.count = member.segments >= 3 ? 4 : 2;
  const int begin = point.count == 2 ? segment : std::clamp(segment - 1, 0, member.segments - 3);
  for (int i = 0; i < point.count; ++i) {  // Lagrange's weights
    double weight = 1;
    for (int j = 0; j < point.count; ++j) {
      const double other = places[at(begin + j)];
      if (j != i) weight *= (s - other) / (places[at(begin + i)] - other);
    }
    point.node[at(i)] = member.nodes[at(begin + i)];
    point.weight[at(i)] = weight;
  }
  return point;
}

/// Between the nodes of the segment that it stands in, or at one of them.
PointMass point_mass_on(const ChainMember& member, int index, const AttachedMass& mass) {
  const double s = std::clamp(mass.position, 0.0, 1.0);
  const std::size_t i = at(member.segment_at(s));
  const double length = member.places[i + 1] - member.places[i];
  return {
      {member.nodes[i], member.nodes[i + 1]}, (s - member.places[i]) / length, mass.mass, index};
}

/// Numbers along the scene's axes along the chain's, which are a permutation of them wherever a
/// support is elastic and the plane is not the scene's z.
Vector3d permuted(const Matrix3d& axes, const Vector3d& numbers) {
  Vector3d out;
  for (int row = 0; row < 3; ++row) {
    Index column = 0;
    axes.row(row).cwiseAbs().maxCoeff(&column);
    out[row] = numbers[column];
  }
  return out;
}

/// Each node's neighbours are near it in the order of a breadth-first walk from a node at the rig's
/// edge (E. Cuthill and J. McKee, Proc. 24th ACM Nat. Conf., 1969).
std::vector<int> walk(const Chain& chain) {
  const auto n = at(chain.nodes);
  std::vector<std::vector<int>> neighbours(n);
  for (const Segment& s : chain.segments) {
    neighbours[at(s.a)].push_back(s.b);
    neighbours[at(s.b)].push_back(s.a);
  }
  std::vector<int> all, order;
  std::vector<bool> met(n, false);
  const auto breadth_first = [&](int start) {
    order.assign(1, start);
    met[at(start)] = true;
    for (std::size_t head = 0; head < order.size(); ++head) {
      for (const int next : neighbours[at(order[head])]) {
        if (met[at(next)]) continue;
        met[at(next)] = true;
        order.push_back(next);
      }
    }
  };
  for (int start = 0; start < chain.nodes; ++start) {
    if (met[at(start)]) continue;
    int edge = start;
    for (int sweep = 0; sweep < 2; ++sweep) {  // the farthest node of the farthest
      breadth_first(edge);
      edge = order.back();
      for (const int node : order) met[at(node)] = false;
    }
    breadth_first(edge);
    all.insert(all.end(), order.begin(), order.end());
  }
  return all;
}

}  // namespace

Chain Chain::from_scene(const Scene& scene, const ChainOptions& options) {
  if (!is_actual(scene)) return from_scene(actual_state(scene), options);
  const auto ends = member_nodes(scene);
  const ModelReduction reduction = reduce_model(scene, options.torsion);
  Chain chain;
  chain.axes = reduction.axes;
  chain.gravity = chain.axes * scene.gravity;
  chain.planar = reduction.planar;
  chain.rotary_inertia = options.rotary_inertia;

  // Nodes: the scene's, then those inside each member.
  const auto scene_nodes = static_cast<int>(scene.nodes.size());
  chain.scene_nodes = chain.nodes = scene_nodes;
  chain.members.resize(scene.members.size());
  for (std::size_t m = 0; m < scene.members.size(); ++m) {
    ChainMember& out = chain.members[m];
    out.even = m >= options.places.size() || options.places[m].empty();
    if (out.even) {
      const int asked = m < options.segments.size() ? options.segments[m] : 0;
      const int own = scene.members[m].segments > 0 ? scene.members[m].segments : kDefaultSegments;
      const int n = std::max(2, asked > 0 ? asked : own);
      for (int i = 0; i <= n; ++i) out.places.push_back(double(i) / n);
    } else {
      out.places = options.places[m];
    }
    out.segments = static_cast<int>(out.places.size()) - 1;
    chain.nodes += out.segments - 1;
  }
  chain.drawn.resize(3, chain.nodes);
  chain.fixed.setConstant(3, chain.nodes, false);
  const auto rotations =
      static_cast<Index>(std::ranges::count(reduction.attitude, NodeAttitude::turning));
  chain.rotation_fixed.setConstant(3, rotations, false);

  std::vector<int> rotation_of(scene.nodes.size(), -1);
  for (int k = 0; k < scene_nodes; ++k) {
    const auto index = at(k);
    const SceneNode& node = scene.nodes[index];
    chain.drawn.col(k) = chain.axes * node.position;
    if (node.support.kind == Support::Kind::clamped || node.support.kind == Support::Kind::pinned) {
      chain.fixed.col(k).setConstant(true);
    }
    if (node.mass > 0) chain.masses.push_back({{k, k}, 0, node.mass, -1});
    NodeSupport support;
    support.node = k;
    if (reduction.attitude[index] == NodeAttitude::turning) {
      rotation_of[index] = support.rotation = static_cast<int>(chain.rotating_node.size());
      chain.rotating_node.push_back(k);
    }
    if (node.support.kind == Support::Kind::elastic) {
      const auto hold = [](double& stiffness, bool& held) {
        if (!std::isinf(stiffness)) return;
        held = true;
        stiffness = 0;
      };
      support.translational = permuted(chain.axes, node.support.translational);
      if (support.rotation >= 0) {
        support.rotational = permuted(chain.axes, node.support.rotational);
      }
      for (int axis = 0; axis < 3; ++axis) {
        hold(support.translational[axis], chain.fixed(axis, k));
        if (support.rotation < 0) continue;
        hold(support.rotational[axis], chain.rotation_fixed(axis, support.rotation));
      }
      chain.supports.push_back(support);
    }
  }

  int next_node = scene_nodes;
  for (std::size_t m = 0; m < scene.members.size(); ++m) {
    const Member& member = scene.members[m];
    ChainMember& out = chain.members[m];
    const int n = out.segments;
    out.cable = member.kind == Member::Kind::cable;
    out.first_segment = static_cast<int>(chain.segments.size());
    out.first_joint = static_cast<int>(chain.inner_joints.size());
    const Vector3d from = chain.drawn.col(ends[m][0]), to = chain.drawn.col(ends[m][1]);
    const Vector3d chord = to - from;
    if (!(chord.norm() > 0)) {
      throw SceneError({scene.file, 0, 0, "member \"" + member.name + "\".nodes"},
                       "both nodes are at the same place", "give the nodes different positions");
    }
    out.unstretched_length = chord.norm();
    if (out.cable) {
      if (member.unstretched_length) out.unstretched_length = *member.unstretched_length;
      if (member.stretch) out.unstretched_length = chord.norm() - *member.stretch;
      out.target_tension = member.tension;
    }
    if (!(out.unstretched_length > 0)) {
      throw SceneError({scene.file, 0, 0, "member \"" + member.name + "\".stretch"},
                       "no unstretched length is left",
                       "give a stretch smaller than the distance of the nodes");
    }
    // Horizontal part of the chord; the chord itself where it is within 5 degrees of vertical.
    out.tension_direction = chord.normalized();
    if (chain.gravity.norm() > 0) {
      const Vector3d up = chain.gravity.normalized();
      const Vector3d level = chord - up * up.dot(chord);
      if (level.norm() > 0.0872 * chord.norm()) out.tension_direction = level.normalized();
    }

    const bool framed = reduction.torsion[m];
    const Matrix3d axes = chain.axes * material_axes(chain.axes.transpose() * chord);
    const std::vector<double>& places = out.places;
    const Sections sections(member, places, out.even, out.unstretched_length);
    const bool accurate = options.rotary_inertia == RotaryInertia::accurate;
    const double tension = accurate ? nominal_tension(member, chord, chain.gravity) : 0;
    const AxialForce axial = options.rotary_inertia == RotaryInertia::rigid_rod
                                 ? AxialForce{}
                                 : nominal_axial_force(scene, ends, m);
    std::array<bool, 2> bent{false, false};  // ends that bear a moment
    for (std::size_t e = 0; e < 2; ++e) {
      bent[e] = member.joint[e] == Member::Joint::rigid &&
                reduction.attitude[at(ends[m][e])] != NodeAttitude::released;
    }
    const std::vector<double> flexibility =
        joint_flexibilities(sections, tension, options.rotary_inertia, bent);
    out.nodes.push_back(ends[m][0]);
    for (int i = 1; i < n; ++i) {
      chain.drawn.col(next_node) = from + chord * places[at(i)];
      out.nodes.push_back(next_node++);
    }
    out.nodes.push_back(ends[m][1]);
    for (int i = 0; i < n; ++i) {
      const auto k = at(i);
      Segment segment;
      segment.a = out.nodes[k];
      segment.b = out.nodes[k + 1];
      segment.member = static_cast<int>(m);
      segment.frame = framed ? chain.frames++ : -1;
      segment.length = sections.segment_length(k);
      segment.EA = sections.EA(k);
      segment.mass = sections.segment_mass(k);
      segment.polar = framed ? sections.polar(k) : 0;
      segment.coupling = mass_coupling(options.rotary_inertia, out.cable);
      segment.axial_damping = member.damping.axial / segment.length;
      chain.segments.push_back(segment);
      if (i > 0) {
        const int here = out.first_segment + i;
        chain.inner_joints.push_back(
            {{here - 1, here},
             sections.springs(k, places[k], flexibility[k], 1, framed, axial.at(places[k]))});
      }
    }
    chain.drawn_director.conservativeResize(3, chain.frames);
    if (framed) chain.drawn_director.rightCols(n).colwise() = axes.col(1);

    for (int end = 0; end < 2; ++end) {
      const auto e = at(end);
      if (member.joint[e] == Member::Joint::pinned) continue;
      const auto node = at(ends[m][e]);
      EndJoint joint;
      joint.segment = end == 0 ? out.first_segment : out.first_segment + n - 1;
      // The paper's joint is in the middle of its half segment.
      const double place = options.rotary_inertia == RotaryInertia::rigid_rod ? 0.25 / n : 0;
      const std::size_t joint_index = end == 0 ? 0 : at(n);
      joint.springs =
          sections.springs(joint_index, end == 0 ? place : 1 - place, flexibility[joint_index], 0.5,
                           framed, axial.at(end) * (accurate ? kClampedAxial : 1));
      joint.directors = axes;
      joint.stress_free_at_equilibrium =
          out.cable && member.assembled == Member::Assembled::hanging;
      if (reduction.attitude[node] == NodeAttitude::released) {
        // Only a pinned support's hold on the twist.
        if (scene.nodes[node].support.kind != Support::Kind::pinned || !framed) continue;
        joint.springs.about_1 = joint.springs.about_2 = joint.springs.bending_damping = 0;
      }
      joint.rotation = rotation_of[node];
      const JointSprings& k = joint.springs;
      if (k.about_1 + k.about_2 + k.torsion + k.bending_damping + k.torsion_damping == 0) continue;
      out.end_joint[e] = static_cast<int>(chain.end_joints.size());
      chain.end_joints.push_back(joint);
    }
    for (const AttachedMass& mass : member.masses) {
      chain.masses.push_back(point_mass_on(out, static_cast<int>(m), mass));
    }
  }

  // Axes of each turning node, by its rotational stiffness as drawn.
  chain.rotation_basis.assign(chain.rotating_node.size(), Matrix3d::Identity());
  std::vector<Matrix3d> stiffness(chain.rotating_node.size(), Matrix3d::Zero());
  for (const EndJoint& joint : chain.end_joints) {
    if (joint.rotation < 0) continue;
    const Vector3d k(joint.springs.torsion, joint.springs.about_1, joint.springs.about_2);
    stiffness[at(joint.rotation)] += joint.directors * k.asDiagonal() * joint.directors.transpose();
  }
  for (const NodeSupport& support : chain.supports) {
    if (support.rotation >= 0) stiffness[at(support.rotation)].diagonal() += support.rotational;
  }
  for (Index r = 0; r < rotations; ++r) {
    const auto k = static_cast<std::size_t>(r);
    if (chain.rotation_fixed.col(r).any()) continue;  // held, about coordinate axes
    // The plane's normal stays an axis; the solver returns rising eigenvalues.
    Vector3d values;
    if (chain.planar) {
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
      eigen.computeDirect(stiffness[k].topLeftCorner<2, 2>());
      chain.rotation_basis[k].topLeftCorner<2, 2>() = eigen.eigenvectors();
      values << eigen.eigenvalues(), stiffness[k](2, 2);
    } else {
      const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(stiffness[k]);
      chain.rotation_basis[k] = eigen.eigenvectors();
      values = eigen.eigenvalues();
    }
    const double largest = values.maxCoeff();
    for (int axis = 0; axis < 3; ++axis) {
      if (!(values[axis] > 1e-12 * largest)) chain.rotation_fixed(axis, r) = true;
    }
  }

  const auto locate = [&](const Place& place) {
    if (!place.member.empty()) {
      const int member = index_named(scene, scene.members, place.member);
      return point_on(chain.members[at(member)], place.position);
    }
    const int node = index_named(scene, scene.nodes, place.node);
    const auto ends_there = [&](const Segment& s) { return s.a == node || s.b == node; };
    const auto segment = std::ranges::find_if(chain.segments, ends_there);
    return ChainPoint{{node}, {1}, 1, static_cast<int>(segment - chain.segments.begin())};
  };
  for (const Load& load : scene.loads) {
    chain.load_direction.push_back(chain.axes * load.direction);
    chain.loads.push_back(locate(load.place));
  }
  for (const Sensor& sensor : scene.sensors) {
    chain.sensor_direction.push_back(chain.axes * sensor.direction);
    chain.sensors.push_back(locate(sensor.place));
  }
  chain.along = walk(chain);
  return chain;
}

int ChainMember::segment_at(double s) const {
  const auto after = std::upper_bound(places.begin(), places.end(), s) - places.begin();
  return std::clamp(static_cast<int>(after) - 1, 0, segments - 1);
}

void Chain::set_unstretched_length(int index, double length) {
  ChainMember& member = members[at(index)];
  const double ratio = length / member.unstretched_length;
  if (ratio == 1) return;
  member.unstretched_length = length;
  for (int i = 0; i < member.segments; ++i) {
    Segment& segment = segments[at(member.first_segment + i)];
    segment.length = member.even ? length / member.segments : segment.length * ratio;
    segment.mass *= ratio;
    segment.polar *= ratio;
    segment.axial_damping /= ratio;
  }
  const auto rescale = [ratio](JointSprings& springs) {
    springs.about_1 /= ratio;
    springs.about_2 /= ratio;
    springs.torsion /= ratio;
    springs.bending_damping /= ratio;
    springs.torsion_damping /= ratio;
  };
  for (int i = 0; i + 1 < member.segments; ++i) {
    rescale(inner_joints[at(member.first_joint + i)].springs);
  }
  for (const int joint : member.end_joint) {
    if (joint >= 0) rescale(end_joints[at(joint)].springs);
  }
}

std::vector<int> Chain::segment_counts() const {
  std::vector<int> counts;
  for (const ChainMember& member : members) counts.push_back(member.segments);
  return counts;
}

void settle(Chain& chain, const ChainState& state) {
  for (EndJoint& joint : chain.end_joints) {
    if (!joint.stress_free_at_equilibrium) continue;
    joint.directors = directed(chain, state, joint.segment).directors;
    if (joint.rotation >= 0) {
      const Matrix3d& turn = state.rotation[at(joint.rotation)];
      joint.directors = (turn.transpose() * joint.directors).eval();
    }
  }
  chain.settled = true;
}

Directed directed(const Chain& chain, const ChainState& state, int segment) {
  const Segment& s = chain.segments[at(segment)];
  const Vector3d e = state.position.col(s.b) - state.position.col(s.a);
  Directed out;
  out.length = e.norm();
  out.directors.col(0) = e / out.length;
  if (s.frame >= 0) {
    out.directors.col(1) = state.director.col(s.frame);
    out.directors.col(2) = out.directors.col(0).cross(out.directors.col(1));
  } else {
    out.directors.rightCols<2>().setZero();
  }
  return out;
}

VectorXd axial_forces(const Chain& chain, const ChainState& state) {
  VectorXd forces(static_cast<Index>(chain.segments.size()));
  for (Index k = 0; k < forces.size(); ++k) {
    const Segment& s = chain.segments[static_cast<std::size_t>(k)];
    const double length = (state.position.col(s.b) - state.position.col(s.a)).norm();
    forces[k] = s.EA * (length / s.length - 1);
  }
  return forces;
}

void carry_frames(const Chain& chain, const ChainState& from, ChainState& to) {
  for (const Segment& s : chain.segments) {
    if (s.frame < 0) continue;
    const Vector3d t = (from.position.col(s.b) - from.position.col(s.a)).normalized();
    const Vector3d after = (to.position.col(s.b) - to.position.col(s.a)).normalized();
    to.director.col(s.frame) = transported(from.director.col(s.frame), t, after);
  }
}

Vector3d transported(const Vector3d& d, const Vector3d& from, const Vector3d& to) {
  return d - d.dot(to) / (1 + from.dot(to)) * (from + to);
}

ChainState drawn_state(const Chain& chain) {
  ChainState state;
  state.position = chain.drawn;
  state.director = chain.drawn_director;
  state.rotation.assign(chain.rotating_node.size(), Matrix3d::Identity());
  return state;
}

Vector3d position_of(const ChainPoint& point, const Matrix3Xd& position) {
  Vector3d sum = Vector3d::Zero();
  for (int k = 0; k < point.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    sum += point.weight[i] * position.col(point.node[i]);
  }
  return sum;
}

}  // namespace rigfit::model
