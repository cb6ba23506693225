// d omega^2 / dp = phi' (dK/dp - omega^2 dM/dp) phi with the change of the equilibrium with p in
// dK/dp: the state moves by du/dp = -J^-1 dR/dp, u the displacements and the unknown unstretched
// lengths, J the bordered tangent of the equilibrium.
//
// Derivatives at fixed state, and of the matrices along the moving state, are central differences
// of assembled quantities (one-sided at a bound of zero): no eigenvalue problem and no equilibrium
// is solved again. Shapes follow by Nelson's method (R. B. Nelson, AIAA Journal 14, 1976).
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "model/damped_modes.h"
#include "model/modal_analysis.h"
#include "model/modes.h"
#include "model/parameters.h"
#include "model/segment_choice.h"

namespace rigfit::model {
namespace {

constexpr double kStep =
    3e-6;  // relative: small, as the path to first order stretches stiff cables by its square

/// A scene a little to one side of another, in its equilibrium to first order.
struct Side {
  Scene scene;
  Chain chain;
  ChainState state;
};

class Equations {
 public:
  Equations(const Scene& scene, const ChainModes& modes)
      : scene_(scene), modes_(modes), loose_(*modes.chain) {
    loose_.settled = false;
    assembly_ =
        std::make_unique<Assembly>(loose_, loose_.planar ? Motion::in_plane : Motion::space);
    const int n = assembly_->size();
    for (std::size_t m = 0; m < loose_.members.size(); ++m) {
      if (loose_.members[m].target_tension) targets_.push_back(static_cast<int>(m));
    }
    const auto k = static_cast<Eigen::Index>(targets_.size());
    Eigen::VectorXd force(n), column(n);
    EnvelopeMatrix tangent = assembly_->matrix();
    assembly_->force_and_tangent(modes.equilibrium.state, force, tangent);
    // Rotations that nothing bears while the joints are not settled keep their place.
    for (int i = 0; i < n; ++i) {
      if (tangent.at(i, i) == 0) tangent.add(i, i, 1);
    }
    factor_.factor(tangent);
    border_.resize(n, k);
    gradient_.resize(n, k);
    Eigen::MatrixXd small = Eigen::MatrixXd::Zero(k, k);
    for (Eigen::Index i = 0; i < k; ++i) {
      double by_length = 0;
      assembly_->tension_gradient(modes.equilibrium.state, targets_[std::size_t(i)], column,
                                  by_length);
      gradient_.col(i) = column;
      small(i, i) = by_length;
      assembly_->length_derivative(modes.equilibrium.state, targets_[std::size_t(i)], column);
      border_.col(i) = column;
    }
    factor_.solve_in_place(border_);
    small -= gradient_.transpose() * border_;
    small_.setThreshold(1e-9);
    if (k > 0) small_.compute(small);
  }

  /// False: the scenes beside this one have other unknowns (a plane of symmetry lost).
  bool moved(const ParameterAccess& access, double value, double low, double high,
             std::array<Side, 2>& sides) const {
    const double points[2] = {low, high};
    std::array<Eigen::VectorXd, 2> force, tension;
    const auto k = static_cast<Eigen::Index>(targets_.size());
    (void)value;
    for (std::size_t s = 0; s < 2; ++s) {
      Side& side = sides[s];
      side.scene = scene_;
      access.set(side.scene, points[s]);
      ChainOptions options;
      for (const ChainMember& member : modes_.chain->members) {
        options.segments.push_back(member.segments);
      }
      options.rotary_inertia = modes_.chain->rotary_inertia;
      options.torsion = modes_.chain->torsion;
      side.chain = Chain::from_scene(side.scene, options);
      if (side.chain.planar != loose_.planar || !side.chain.axes.isApprox(loose_.axes, 1e-12) ||
          side.chain.frames != loose_.frames ||
          side.chain.end_joints.size() != loose_.end_joints.size() ||
          side.chain.rotating_node != loose_.rotating_node) {
        return false;
      }
      for (const int m : targets_) {
        side.chain.set_unstretched_length(m,
                                          modes_.chain->members[std::size_t(m)].unstretched_length);
      }
      place(side);
      const Assembly assembly(side.chain, assembly_->numbering().motion);
      if (assembly.size() != assembly_->size()) return false;
      force[s].resize(assembly.size());
      assembly.force(side.state, force[s]);
      tension[s].resize(k);
      for (Eigen::Index i = 0; i < k; ++i) {
        const int m = targets_[std::size_t(i)];
        tension[s][i] =
            assembly.tension(side.state, m) - *side.chain.members[std::size_t(m)].target_tension;
      }
    }
    const double width = high - low;
    Eigen::VectorXd q = -(force[1] - force[0]) / width;
    factor_.solve_in_place(q);
    Eigen::VectorXd lengths(k);
    if (k > 0) {
      const Eigen::VectorXd right = -(tension[1] - tension[0]) / width - gradient_.transpose() * q;
      lengths = small_.solve(right);
      q -= border_ * lengths;
    }
    const double base = value;
    for (std::size_t s = 0; s < 2; ++s) {
      Side& side = sides[s];
      const Assembly assembly(side.chain, assembly_->numbering().motion);
      const double factor = points[s] - base;
      assembly.advance(side.state, q, factor, side.state);
      for (Eigen::Index i = 0; i < k; ++i) {
        const int m = targets_[std::size_t(i)];
        side.chain.set_unstretched_length(
            m, side.chain.members[std::size_t(m)].unstretched_length + factor * lengths[i]);
      }
      settle(side.chain, side.state);
    }
    return true;
  }

 private:
  /// The equilibrium's positions, held displacements where this side's nodes are drawn; frames
  /// follow their segments.
  void place(Side& side) const {
    const ChainState& rest = modes_.equilibrium.state;
    side.state = rest;
    for (int node = 0; node < side.chain.nodes; ++node) {
      for (int axis = 0; axis < 3; ++axis) {
        if (side.chain.fixed(axis, node)) {
          side.state.position(axis, node) = side.chain.drawn(axis, node);
        }
      }
    }
    for (const Segment& s : side.chain.segments) {
      if (s.frame < 0) continue;
      const Eigen::Vector3d t = (rest.position.col(s.b) - rest.position.col(s.a)).normalized();
      const Eigen::Vector3d after =
          (side.state.position.col(s.b) - side.state.position.col(s.a)).normalized();
      const Eigen::Vector3d d = rest.director.col(s.frame);
      side.state.director.col(s.frame) = d - d.dot(after) / (1 + t.dot(after)) * (t + after);
    }
  }

  const Scene& scene_;
  const ChainModes& modes_;
  Chain loose_;
  std::unique_ptr<Assembly> assembly_;
  std::vector<int> targets_;
  EnvelopeFactor factor_;
  Eigen::MatrixXd border_, gradient_;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> small_;
};

/// Matrices of one motion on one side.
MotionModes side_motion(const Side& side, Motion motion) {
  MotionModes out;
  out.motion = motion;
  out.assembly = std::make_unique<Assembly>(side.chain, motion);
  out.stiffness = out.assembly->matrix();
  out.mass = out.assembly->matrix();
  Eigen::VectorXd force(out.assembly->size());
  out.assembly->force_and_tangent(side.state, force, out.stiffness);
  out.assembly->mass(out.mass);
  return out;
}

}  // namespace

ModeSensitivities analyse_mode_sensitivities(const Scene& scene,
                                             const std::vector<std::string>& parameters,
                                             const ModesOptions& options) {
  const auto all = scene_parameters(scene);
  std::vector<const ParameterAccess*> wanted;
  for (const std::string& name : parameters) {
    (void)parameter(scene, name);  // throws for an unknown one
    for (const auto& access : all) {
      if (access.name == name) wanted.push_back(&access);
    }
  }
  ModeSensitivities out;
  const SegmentChoice choice = choose_segments(scene, options);
  const ChainModes& modes = choice.modes;
  out.analysis.equilibrium = describe(*modes.chain, modes.equilibrium, scene);
  out.analysis.relative_error_estimate = choice.error.relative;
  const auto count = static_cast<Eigen::Index>(modes.order.size());
  const auto columns = static_cast<Eigen::Index>(wanted.size());
  out.frequency.setZero(count, columns);
  out.damping_ratio.setZero(count, columns);
  out.sensor_shape.assign(
      wanted.size(), Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(scene.sensors.size()), count));
  if (modes.equilibrium.status != EquilibriumStatus::converged) return out;
  out.analysis.modes = natural_modes(modes, scene, options);
  out.analysis.complete = modes.complete();
  for (const MotionModes& motion : modes.motions) out.analysis.unknowns += motion.assembly->size();

  const Equations equations(scene, modes);
  double extent = 0;
  for (const auto& member : out.analysis.equilibrium.members) {
    extent = std::max(extent, member.unstretched_length_m);
  }
  std::vector<DampedModes> damped;
  for (const MotionModes& motion : modes.motions) {
    damped.push_back(damped_modes(motion, modes.equilibrium.state, scene));
  }
  for (Eigen::Index p = 0; p < columns; ++p) {
    const ParameterAccess& access = *wanted[std::size_t(p)];
    const double value = access.get(scene);
    const bool place = access.unit == "m";
    // Forces move the rig most; what moves it little is stepped farther, against rounding.
    const double relative = access.unit == "N" ? kStep : 30 * kStep;
    // A number that may not be negative is stepped to one side from zero.
    const double step =
        place ? 0.1 * kStep * extent : (value != 0 ? relative * std::abs(value) : 1e-6);
    const double low = !place && value == 0 ? 0 : value - step, high = value + step;
    std::array<Side, 2> sides;
    if (!equations.moved(access, value, low, high, sides)) {
      // Out of a plane of symmetry frequencies are even in p; anything else is left to differences.
      const auto shifted = [&](double at) {
        Scene moved = scene;
        access.set(moved, at);
        std::vector<int> segments;
        for (const auto& member : modes.chain->members) segments.push_back(member.segments);
        return find_modes(moved, options, segments);
      };
      const ChainModes below = shifted(low), above = shifted(high);
      for (Eigen::Index i = 0; i < count; ++i) {
        const auto k = static_cast<std::size_t>(i);
        if (below.order.size() > k && above.order.size() > k) {
          out.frequency(i, p) = (above.frequency_hz(k) - below.frequency_hz(k)) / (high - low);
        }
      }
      continue;
    }
    for (std::size_t m = 0; m < modes.motions.size(); ++m) {
      const MotionModes& motion = modes.motions[m];
      if (motion.omega2.size() == 0) continue;
      MotionModes below = side_motion(sides[0], motion.motion);
      MotionModes above = side_motion(sides[1], motion.motion);
      const double width = high - low;
      EnvelopeMatrix dk = above.stiffness, dm = above.mass;
      if (dk.values().size() != below.stiffness.values().size()) continue;
      dk.values() = (above.stiffness.values() - below.stiffness.values()) / width;
      dm.values() = (above.mass.values() - below.mass.values()) / width;

      const Eigen::Index n = motion.shapes.rows();
      Eigen::MatrixXd shape_rate(n, motion.omega2.size());
      Eigen::VectorXd omega2_rate(motion.omega2.size());
      for (Eigen::Index i = 0; i < motion.omega2.size(); ++i) {
        const Eigen::VectorXd phi = motion.shapes.col(i);
        const Eigen::VectorXd dk_phi = dk * phi, dm_phi = dm * phi, m_phi = motion.mass * phi;
        omega2_rate[i] = phi.dot(dk_phi) - motion.omega2[i] * phi.dot(dm_phi);
        Eigen::VectorXd v = -(dk_phi - motion.omega2[i] * dm_phi) + omega2_rate[i] * m_phi;
        // (K - omega^2 M) v = right, with v = 0 where phi is largest: any stiffness added there
        // makes the matrix regular and, the right side being normal to phi, changes nothing.
        EnvelopeMatrix shifted = motion.stiffness;
        shifted.values() -= motion.omega2[i] * motion.mass.values();
        Eigen::Index largest = 0;
        m_phi.cwiseAbs().maxCoeff(&largest);
        shifted.add(int(largest), int(largest), motion.stiffness.at(int(largest), int(largest)));
        EnvelopeFactor factor;
        factor.factor(shifted);
        factor.solve_in_place(v);
        shape_rate.col(i) = v - (m_phi.dot(v) + 0.5 * phi.dot(dm_phi)) * phi;
      }

      // Damping: the shapes move too.
      below.omega2 = motion.omega2 + (low - value) * omega2_rate;
      above.omega2 = motion.omega2 + (high - value) * omega2_rate;
      below.shapes = motion.shapes + (low - value) * shape_rate;
      above.shapes = motion.shapes + (high - value) * shape_rate;
      Eigen::VectorXd damping_rate = Eigen::VectorXd::Zero(motion.omega2.size());
      if (options.damped) {
        const DampedModes d0 = damped_modes(below, sides[0].state, sides[0].scene);
        const DampedModes d1 = damped_modes(above, sides[1].state, sides[1].scene);
        for (Eigen::Index i = 0; i < damping_rate.size(); ++i) {
          damping_rate[i] = (damping_ratio_of(d1.poles[i]) - damping_ratio_of(d0.poles[i])) / width;
        }
      }
      for (Eigen::Index i = 0; i < count; ++i) {
        const auto& which = modes.order[std::size_t(i)];
        if (which.motion != int(m)) continue;
        const double omega = std::sqrt(motion.omega2[which.mode]);
        out.frequency(i, p) = omega2_rate[which.mode] / (4 * M_PI * omega);
        out.damping_ratio(i, p) = damping_rate[which.mode];
        for (std::size_t s = 0; s < scene.sensors.size(); ++s) {
          const Eigen::VectorXd row0 =
              sensor_row(*below.assembly, sides[0].state, sides[0].scene, int(s));
          const Eigen::VectorXd row1 =
              sensor_row(*above.assembly, sides[1].state, sides[1].scene, int(s));
          out.sensor_shape[std::size_t(p)](Eigen::Index(s), i) =
              (row1.dot(above.shapes.col(which.mode)) - row0.dot(below.shapes.col(which.mode))) /
              width;
        }
      }
    }
  }
  return out;
}

}  // namespace rigfit::model
