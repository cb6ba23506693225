#include "model/linear/modal_analysis.h"

#include "model/linear/damped_modes.h"
#include "model/linear/modes.h"
#include "model/linear/segment_extrapolation.h"
#include "model/scene/model_reduction.h"
#include "model/statics/equilibrium.h"

namespace rigfit::model {

namespace {

constexpr double kMostly = 0.9;  // share of kinetic energy that gives a mode its family or plane

struct Motions {
  double in = 0, out = 0, twist = 0, along = 0;  // shares of the members' kinetic energy
  std::vector<double> member;                    // q' M q of each, of which all have one
};

Motions motions_of(const Chain& chain, const ChainState& state, const Assembly& assembly,
                   const VectorXd& q) {
  Motions sum;
  const Numbering& numbering = assembly.numbering();
  const auto at = [&](int node) { return numbering.displacement_in(q, node); };
  double total = 0;
  sum.member.assign(chain.members.size(), 0);
  for (const PointMass& mass : chain.masses) {
    if (mass.member < 0) continue;
    const Vector3d v = (1 - mass.fraction) * at(mass.node[0]) + mass.fraction * at(mass.node[1]);
    sum.member[std::size_t(mass.member)] += mass.mass * v.squaredNorm();
  }
  for (std::size_t k = 0; k < chain.segments.size(); ++k) {
    const Segment& s = chain.segments[k];
    const Vector3d t = (state.position.col(s.b) - state.position.col(s.a)).normalized();
    const Vector3d va = at(s.a), vb = at(s.b), v = 0.5 * (va + vb);
    double& own = sum.member[std::size_t(s.member)];
    own += s.mass * ((0.5 - s.coupling) * (va.squaredNorm() + vb.squaredNorm()) +
                     2 * s.coupling * va.dot(vb));
    sum.out += s.mass * v.z() * v.z();
    sum.in += s.mass * v.head<2>().squaredNorm();
    sum.along += s.mass * v.dot(t) * v.dot(t);
    total += s.mass * v.squaredNorm();
    const int twist = numbering.twist[static_cast<Index>(k)];
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
                const VectorXd& q, NaturalMode& out) {
  const Chain& chain = *modes.chain;
  const Numbering& numbering = motion.assembly->numbering();
  const Matrix3d back = chain.axes.transpose();
  for (std::size_t m = 0; m < chain.members.size(); ++m) {
    const ChainMember& member = chain.members[m];
    ModeShape shape;
    shape.member = scene.members[m].name;
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

/// In the order of ChainModes::order.
std::vector<NaturalMode> natural_modes(const ResolvedModes& resolved, const Scene& scene,
                                       const ModesOptions& options) {
  std::vector<NaturalMode> out;
  const ChainModes& modes = resolved.modes;
  const Chain& chain = *modes.chain;
  const ChainState& state = modes.equilibrium.state;
  struct Prepared {
    VectorXcd poles;
    MatrixXd sensors, loads;  // rows by sensor, load
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
    const VectorXd q = motion.shapes.col(which.mode);
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

/// What leaving torsion out changes: the largest relative change of a frequency.
double torsion_cost(const Scene& scene, const ModesOptions& options,
                    const std::vector<int>& segments) {
  ModesOptions with = options;
  with.torsion.reset();
  const ChainModes full = find_modes(scene, with, segments);
  const ChainModes without = find_modes(scene, options, segments);
  double cost = 0;
  for (std::size_t i = 0; i < without.order.size() && !full.order.empty(); ++i) {
    const double hz = without.frequency_hz(i);
    if (hz > full.frequency_hz(full.order.size() - 1)) break;
    double nearest = HUGE_VAL;  // modes of torsion lie between the others
    for (std::size_t k = 0; k < full.order.size(); ++k) {
      nearest = std::min(nearest, std::abs(full.frequency_hz(k) / hz - 1));
    }
    cost = std::max(cost, nearest);
  }
  return cost;
}

constexpr int kSegmentsForCost = 16;  // chains that are only compared with each other

/// What beams' section inertia and shear, which chains do not have, would take off a frequency: the
/// largest relative part of all bending modes. Timoshenko's first term, (k r)^2 (1 + E / kappa G) /
/// 2 with the wave number k^4 = m omega^2 / EI, r^2 = EI / EA and E / kappa G = 2.6 * 6 / 5 of a
/// solid metal section, weighted by the beams' share of kinetic energy.
double section_cost(const Scene& scene, const std::vector<NaturalMode>& modes) {
  constexpr double kInertiaAndShear = (1 + 2.6 * 6 / 5) / 2;
  double cost = 0;
  for (const NaturalMode& mode : modes) {
    if (mode.plane == ModePlane::axial || mode.plane == ModePlane::torsion) continue;
    double own = 0;
    for (std::size_t m = 0; m < scene.members.size(); ++m) {
      const Member& beam = scene.members[m];
      if (beam.kind != Member::Kind::beam || !(beam.EA > 0)) continue;
      const double EI = mode.plane == ModePlane::out  ? beam.EI[1]
                        : mode.plane == ModePlane::in ? beam.EI[0]
                                                      : std::max(beam.EI[0], beam.EI[1]);
      own += mode.kinetic_energy.all[m].second * kInertiaAndShear * 2 * M_PI * mode.frequency_hz *
             std::sqrt(beam.mass_per_length * EI) / beam.EA;
    }
    cost = std::max(cost, own);
  }
  return cost;
}

}  // namespace

ModalAnalysis analysis_of(const ResolvedModes& resolved, const Scene& scene,
                          const ModesOptions& options) {
  ModalAnalysis out;
  const ChainModes& modes = resolved.modes;
  out.extrapolated = resolved.extrapolated;
  out.relative_error_estimate = resolved.relative_error;
  out.equilibrium = describe(*modes.chain, modes.equilibrium, scene);
  for (const MotionModes& motion : modes.motions) out.unknowns += motion.assembly->size();
  if (modes.equilibrium.status != EquilibriumStatus::converged) return out;
  out.modes = natural_modes(resolved, scene, options);
  out.complete = modes.complete();
  return out;
}

ModalAnalysis analyse_modes(const Scene& scene, const ModesOptions& options) {
  const ResolvedModes resolved = resolve_modes(scene, options);
  ModalAnalysis out = analysis_of(resolved, scene, options);
  if (out.equilibrium.status != EquilibriumStatus::converged) return out;
  const double section = section_cost(scene, out.modes);
  if (section > 0) out.left_out.push_back({"section inertia and shear of beams", section});

  const Chain& chain = *resolved.modes.chain;
  if (chain.planar) {
    out.kept = {"in-plane motion",
                "out-of-plane motion, separately: the scene has a plane of symmetry"};
  } else {
    out.kept = {"motion in space"};
  }
  out.kept.push_back("axial stretch, dynamically");
  if (chain.frames > 0) {
    out.kept.push_back("torsion");
  } else {
    const ModelReduction reduction = reduce_model(scene, options.torsion);
    double error = 0;
    if (reduction.torsion_left_out) {
      const std::vector<int> few(scene.members.size(), kSegmentsForCost);
      error = torsion_cost(scene, options, out.extrapolated ? few : chain.segment_counts());
    }
    out.left_out.push_back({"torsion", error});
  }
  return out;
}

}  // namespace rigfit::model
