#include "model/linear/mode_description.h"

#include <utility>

#include "model/linear/damped_modes.h"

namespace rigfit::model {
namespace {

constexpr double kMostly = 0.9;  // share of kinetic energy that gives a mode its family or plane

struct Motions {
  double in = 0, out = 0, twist = 0, along = 0;  // shares of the members' kinetic energy
  std::vector<double> member;                    // q' M q of each, of which all have one
};

Motions motions_of(const Chain& chain, const ChainState& state, const Assembly& assembly,
                   const Eigen::VectorXd& q) {
  Motions sum;
  const Numbering& numbering = assembly.numbering();
  const auto at = [&](int node) { return numbering.displacement_in(q, node); };
  double total = 0;
  sum.member.assign(chain.members.size(), 0);
  for (const PointMass& mass : chain.masses) {
    if (mass.member < 0) continue;
    const Eigen::Vector3d v =
        (1 - mass.fraction) * at(mass.node[0]) + mass.fraction * at(mass.node[1]);
    sum.member[std::size_t(mass.member)] += mass.mass * v.squaredNorm();
  }
  for (std::size_t k = 0; k < chain.segments.size(); ++k) {
    const Segment& s = chain.segments[k];
    const Eigen::Vector3d t = (state.position.col(s.b) - state.position.col(s.a)).normalized();
    const Eigen::Vector3d va = at(s.a), vb = at(s.b), v = 0.5 * (va + vb);
    double& own = sum.member[std::size_t(s.member)];
    own += s.mass * ((0.5 - s.coupling) * (va.squaredNorm() + vb.squaredNorm()) +
                     2 * s.coupling * va.dot(vb));
    sum.out += s.mass * v.z() * v.z();
    sum.in += s.mass * v.head<2>().squaredNorm();
    sum.along += s.mass * v.dot(t) * v.dot(t);
    total += s.mass * v.squaredNorm();
    const int twist = numbering.twist[static_cast<Eigen::Index>(k)];
    if (twist >= 0) {
      sum.twist += s.polar * q[twist] * q[twist];
      total += s.polar * q[twist] * q[twist];
      own += s.polar * q[twist] * q[twist];
    }
  }
  if (total > 0) {
    sum.in /= total, sum.out /= total, sum.twist /= total, sum.along /= total;
  }
  return sum;
}

ModePlane plane_of(const Motions& share, Motion motion) {
  if (share.twist > 0.5) return ModePlane::torsion;
  if (share.along > 0.5) return ModePlane::axial;
  if (motion == Motion::in_plane) return ModePlane::in;
  if (motion == Motion::out_of_plane) return ModePlane::out;
  if (share.in > kMostly) return ModePlane::in;
  if (share.out > kMostly) return ModePlane::out;
  return ModePlane::mixed;
}

void fill_shape(const ChainModes& modes, const MotionModes& motion, const Scene& scene,
                const Eigen::VectorXd& q, NaturalMode& out) {
  const Chain& chain = *modes.chain;
  const Numbering& numbering = motion.assembly->numbering();
  const Eigen::Matrix3d back = chain.axes.transpose();
  for (const ChainMember& member : chain.members) {
    ModeShape shape;
    shape.member = scene.members[std::size_t(member.scene_member)].name;
    shape.displacement.resize(3, member.segments + 1);
    for (int i = 0; i <= member.segments; ++i) {
      shape.displacement.col(i) = back * numbering.displacement_in(q, member.nodes[std::size_t(i)]);
    }
    if (chain.segments[std::size_t(member.first_segment)].frame >= 0) {
      shape.twist.setZero(member.segments);
      for (int i = 0; i < member.segments; ++i) {
        const int k = numbering.twist[member.first_segment + i];
        if (k >= 0) shape.twist[i] = q[k];
      }
    }
    out.shape.push_back(std::move(shape));
  }
}

}  // namespace

std::vector<NaturalMode> natural_modes(const ResolvedModes& resolved, const Scene& scene,
                                       const ModesOptions& options) {
  std::vector<NaturalMode> out;
  const ChainModes& modes = resolved.modes;
  const Chain& chain = *modes.chain;
  const ChainState& state = modes.equilibrium.state;
  struct Prepared {
    Eigen::VectorXcd poles;
    Eigen::MatrixXd sensors, loads;  // rows by sensor, load
  };
  std::vector<Prepared> prepared(modes.motions.size());
  for (std::size_t k = 0; k < prepared.size(); ++k) {
    const MotionModes& motion = modes.motions[k];
    if (options.damped) prepared[k].poles = damped_poles(motion, state, scene);
    prepared[k].sensors = sensor_rows(*motion.assembly, state, scene).transpose() * motion.shapes;
    prepared[k].loads = load_rows(*motion.assembly).transpose() * motion.shapes;
  }
  for (std::size_t i = 0; i < modes.order.size(); ++i) {
    const auto& which = modes.order[i];
    const auto k = std::size_t(which.motion);
    const MotionModes& motion = modes.motions[k];
    const Eigen::VectorXd q = motion.shapes.col(which.mode);
    NaturalMode mode;
    mode.frequency_hz = resolved.frequency_hz[i];
    mode.extrapolated_hz = resolved.limit_hz[i];
    if (options.damped) mode.damping_ratio = damping_ratio_of(prepared[k].poles[which.mode]);
    const Motions share_of = motions_of(chain, state, *motion.assembly, q);
    double beams = 0, all = 0;
    for (std::size_t m = 0; m < share_of.member.size(); ++m) {
      const double part = share_of.member[m];
      mode.kinetic_energy.all.emplace_back(scene.members[m].name, part);
      all += part;
      if (!chain.members[m].cable) beams += part;
    }
    const double share = all > 0 ? beams / all : 0;
    mode.family = share > kMostly       ? ModeFamily::beam
                  : share < 1 - kMostly ? ModeFamily::cable
                                        : ModeFamily::hybrid;
    mode.plane = plane_of(share_of, motion.motion);
    if (options.shapes) fill_shape(modes, motion, scene, q, mode);
    mode.sensor_shape = prepared[k].sensors.col(which.mode);
    mode.load_shape = prepared[k].loads.col(which.mode);
    out.push_back(std::move(mode));
  }
  return out;
}

}  // namespace rigfit::model
