#include "model/linear/perturbed_equilibrium.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rigfit::model {
namespace {

// Relative: central differences err by its square, rounding of positions by its inverse.
constexpr double kStep = 1e-4;
constexpr double kFarthest = 1e-5;  // farthest that a step may move the rig, relative to its extent
constexpr int kCorrections = 8;

/// The equilibrium's positions, held displacements where this rig's nodes are drawn; frames follow
/// their segments.
void place(const ChainState& rest, PerturbedEquilibrium& rig) {
  rig.state = rest;
  for (int node = 0; node < rig.chain.nodes; ++node) {
    for (int axis = 0; axis < 3; ++axis) {
      if (rig.chain.fixed(axis, node)) {
        rig.state.position(axis, node) = rig.chain.drawn(axis, node);
      }
    }
  }
  carry_frames(rig.chain, rest, rig.state);
}

}  // namespace

ParameterStep parameter_step(const ParameterAccess& access, const Scene& scene, double extent) {
  ParameterStep step;
  step.value = access.get(scene);
  const bool place = access.unit == "m";
  // Lengths along a cable strain it: a hundredth of what moves a node.
  const bool along = place && (access.name.ends_with("stretch") || access.name.ends_with("length"));
  double size = step.value != 0 ? kStep * std::abs(step.value) : 1e-6;
  if (place) size = (along ? 1e-3 : 0.1) * kStep * extent;
  // What may have any sign at zero: by the tension that it changes, or the length.
  const bool zero = access.name == "load_cell.zero", warmth = access.name == "temperature_change";
  double tension = 0, expansion = 0;
  for (const Member& member : scene.members) {
    tension = std::max(tension, member.tension.value_or(0));
    expansion = std::max(expansion, member.thermal_expansion);
  }
  if (zero) size = kStep * tension;
  if (warmth) size = 1e-3 * kStep / expansion;
  step.low = !place && !zero && !warmth && step.value == 0 ? 0 : step.value - size;
  step.high = step.value + size;
  return step;
}

EquilibriumPerturber::EquilibriumPerturber(const Scene& scene, const ChainModes& modes)
    : scene_(scene), modes_(modes), loose_(*modes.chain) {
  loose_.settled = false;
  assembly_ = std::make_unique<Assembly>(loose_, loose_.planar ? Motion::in_plane : Motion::space);
  const int n = assembly_->size();
  for (std::size_t m = 0; m < loose_.members.size(); ++m) {
    if (loose_.members[m].target_tension) targets_.push_back(static_cast<int>(m));
  }
  const auto k = static_cast<Eigen::Index>(targets_.size());
  Eigen::VectorXd force(n), diagonal(k);
  EnvelopeMatrix tangent = assembly_->matrix();
  assembly_->force_and_tangent(modes.equilibrium.state, force, tangent);
  // Rotations that nothing bears while the joints are not settled keep their place.
  for (int i = 0; i < n; ++i) {
    if (tangent.at(i, i) == 0) tangent.add(i, i, 1);
  }
  Eigen::MatrixXd border(n, k), gradient(n, k);
  for (Eigen::Index i = 0; i < k; ++i) {
    const int m = targets_[std::size_t(i)];
    assembly_->tension_gradient(modes.equilibrium.state, m, gradient.col(i), diagonal[i]);
    assembly_->length_derivative(modes.equilibrium.state, m, border.col(i));
  }
  bordered_.factor(tangent, std::move(border), gradient, diagonal);
}

bool EquilibriumPerturber::beside(const ParameterAccess& access,
                                  const std::array<double, 2>& points,
                                  std::array<PerturbedEquilibrium, 2>& rigs) const {
  for (std::size_t s = 0; s < 2; ++s) {
    PerturbedEquilibrium& rig = rigs[s];
    rig.scene = scene_;
    access.set(rig.scene, points[s]);
    ChainOptions options;
    for (const ChainMember& member : modes_.chain->members) {
      options.segments.push_back(member.segments);
      options.places.push_back(member.even ? std::vector<double>{} : member.places);
    }
    options.rotary_inertia = modes_.chain->rotary_inertia;
    options.torsion = modes_.chain->torsion;
    rig.chain = Chain::from_scene(rig.scene, options);
    if (rig.chain.planar != loose_.planar || !rig.chain.axes.isApprox(loose_.axes, 1e-12) ||
        rig.chain.frames != loose_.frames ||
        rig.chain.end_joints.size() != loose_.end_joints.size() ||
        rig.chain.rotating_node != loose_.rotating_node) {
      return false;
    }
    for (const int m : targets_) {
      rig.chain.set_unstretched_length(m, modes_.chain->members[std::size_t(m)].unstretched_length);
    }
    place(modes_.equilibrium.state, rig);
    rig.assembly = std::make_unique<Assembly>(rig.chain, assembly_->numbering().motion);
    if (rig.assembly->size() != assembly_->size()) return false;
  }
  return true;
}

void EquilibriumPerturber::unbalanced(const PerturbedEquilibrium& rig, Eigen::VectorXd& force,
                                      Eigen::VectorXd& tension) const {
  const Assembly& assembly = *rig.assembly;
  force.resize(assembly.size());
  assembly.force(rig.state, force);
  force = -force;
  tension.resize(static_cast<Eigen::Index>(targets_.size()));
  for (Eigen::Index i = 0; i < tension.size(); ++i) {
    const int m = targets_[std::size_t(i)];
    tension[i] = *rig.chain.members[std::size_t(m)].target_tension - assembly.tension(rig.state, m);
  }
}

void EquilibriumPerturber::advance(PerturbedEquilibrium& rig, const Eigen::VectorXd& by,
                                   const Eigen::VectorXd& by_length, double factor) const {
  rig.assembly->advance(rig.state, by, factor, rig.state);
  for (Eigen::Index i = 0; i < by_length.size(); ++i) {
    const int m = targets_[std::size_t(i)];
    rig.chain.set_unstretched_length(
        m, rig.chain.members[std::size_t(m)].unstretched_length + factor * by_length[i]);
  }
}

bool EquilibriumPerturber::move(const ParameterAccess& access, ParameterStep& step,
                                std::array<PerturbedEquilibrium, 2>& rigs) const {
  double extent = 0;
  for (const ChainMember& member : modes_.chain->members) {
    extent = std::max(extent, member.unstretched_length);
  }
  // To first order along the parameter; a step that moves the rig too far is made smaller.
  Eigen::VectorXd q, lengths;
  for (;;) {
    if (!beside(access, {step.low, step.high}, rigs)) return false;
    std::array<Eigen::VectorXd, 2> force, tension;
    for (std::size_t s = 0; s < 2; ++s) unbalanced(rigs[s], force[s], tension[s]);
    q = (force[1] - force[0]) / step.width();
    lengths = (tension[1] - tension[0]) / step.width();
    bordered_.solve_in_place(q, lengths);
    const double moves = step.width() / 2 * q.cwiseAbs().maxCoeff();
    if (!(moves > 1.5 * kFarthest * extent)) break;
    const double part = kFarthest * extent / moves;
    step.low = step.value + part * (step.low - step.value);
    step.high = step.value + part * (step.high - step.value);
  }
  // Then by corrections with the same tangent to rest.
  const double points[2] = {step.low, step.high};
  for (std::size_t s = 0; s < 2; ++s) {
    PerturbedEquilibrium& rig = rigs[s];
    advance(rig, q, lengths, points[s] - step.value);
    const double first = std::abs(points[s] - step.value) * q.cwiseAbs().maxCoeff();
    double last = first;
    for (int correction = 0; correction < kCorrections; ++correction) {
      Eigen::VectorXd by, by_length;
      unbalanced(rig, by, by_length);
      bordered_.solve_in_place(by, by_length);
      const double size = by.cwiseAbs().maxCoeff();
      if (!(size < 0.5 * last) || !(size > 1e-12 * first)) break;  // what rounding leaves
      last = size;
      advance(rig, by, by_length, 1);
    }
    settle(rig.chain, rig.state);
    rig.assembly.reset();
  }
  return true;
}

MotionModes motion_of(const PerturbedEquilibrium& rig, const MotionModes& like) {
  MotionModes out;
  out.motion = like.motion;
  out.assembly = std::make_unique<Assembly>(rig.chain, like.motion);
  out.stiffness = out.assembly->matrix();
  out.mass = out.assembly->matrix();
  Eigen::VectorXd force(out.assembly->size());
  out.assembly->force_and_tangent(rig.state, force, out.stiffness);
  out.assembly->mass(out.mass);
  return out;
}

}  // namespace rigfit::model
