#include "model/linear/perturbed_equilibrium.h"

#include "model/statics/equilibrium.h"

namespace rigfit::model {
namespace {

// Relative: central differences err by its square, rounding of positions by its inverse.
constexpr double kStep = 1e-4;
constexpr double kFarthest = 1e-5;  // farthest that a step may move the rig, relative to its extent

/// A number that may not be negative is stepped to one side from zero. `extent`: the rig's largest
/// length, m.
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

/// The rig with the parameter at `value`, where the rig itself rests; false: it does not compare.
bool beside(const Scene& scene, const ChainModes& modes, const ParameterAccess& access,
            double value, PerturbedEquilibrium& rig) {
  const Chain& chain = *modes.chain;
  const ChainState& rest = modes.equilibrium.state;
  rig.scene = scene;
  access.set(rig.scene, value);
  ChainOptions options;
  options.segments = chain.segment_counts();
  for (const ChainMember& member : chain.members) {
    options.places.push_back(member.even ? std::vector<double>{} : member.places);
  }
  options.rotary_inertia = chain.rotary_inertia;
  options.torsion = chain.frames > 0;
  rig.chain = Chain::from_scene(rig.scene, options);
  if (rig.chain.planar != chain.planar || !rig.chain.axes.isApprox(chain.axes, 1e-12) ||
      rig.chain.frames != chain.frames || rig.chain.fixed != chain.fixed ||
      rig.chain.end_joints.size() != chain.end_joints.size() ||
      rig.chain.rotating_node != chain.rotating_node ||
      rig.chain.rotation_fixed != chain.rotation_fixed) {
    return false;
  }
  for (std::size_t m = 0; m < chain.members.size(); ++m) {
    if (!chain.members[m].target_tension) continue;
    rig.chain.set_unstretched_length(static_cast<int>(m), chain.members[m].unstretched_length);
  }
  // Held displacements are where this rig's nodes are drawn; frames follow their segments.
  rig.state = rest;
  rig.state.position = chain.fixed.select(rig.chain.drawn, rest.position);
  carry_frames(rig.chain, rest, rig.state);
  return true;
}

}  // namespace

Neighbours neighbours_of(const Scene& scene, const ChainModes& modes, const BorderedSolver& tangent,
                         const ParameterAccess& access) {
  double extent = 0;
  for (const ChainMember& member : modes.chain->members) {
    extent = std::max(extent, member.unstretched_length);
  }
  Neighbours out;
  ParameterStep& step = out.step = parameter_step(access, scene, extent);
  // To a ten-thousandth of the step at least: below it differences are rounding.
  for (int attempt = 0; attempt < 5; ++attempt) {
    out.comparable = beside(scene, modes, access, step.low, out.rigs[0]) &&
                     beside(scene, modes, access, step.high, out.rigs[1]);
    if (!out.comparable) return out;
    double part = 0.1;  // where the step leads too far from rest
    if (std::ranges::all_of(out.rigs, [&](PerturbedEquilibrium& rig) {
          return come_to_rest(rig.chain, rig.state, tangent);
        })) {
      const Matrix3Xd moved = out.rigs[1].state.position - out.rigs[0].state.position;
      const double moves = moved.cwiseAbs().maxCoeff() / 2;
      if (!(moves > 1.5 * kFarthest * extent)) return out;
      part = kFarthest * extent / moves;
    }
    step.low = step.value + part * (step.low - step.value);
    step.high = step.value + part * (step.high - step.value);
  }
  step = parameter_step(access, scene, extent);
  out.comparable = false;
  return out;
}

EnvelopeMatrix rate_of(const EnvelopeMatrix& low, const EnvelopeMatrix& high, double width) {
  EnvelopeMatrix out = high;
  out.values() = (high.values() - low.values()) / width;
  return out;
}

MotionRates motion_rates(const Neighbours& near, const MotionModes& motion) {
  MotionRates out;
  for (std::size_t s = 0; s < 2; ++s) {
    MotionModes& side = out.sides[s];
    side.motion = motion.motion;
    side.assembly = std::make_unique<Assembly>(near.rigs[s].chain, motion.motion);
    side.stiffness = side.mass = side.assembly->matrix();
    VectorXd force(side.assembly->size());
    side.assembly->force_and_tangent(near.rigs[s].state, force, side.stiffness);
    side.assembly->mass(side.mass);
  }
  const double width = near.step.width();
  out.stiffness = rate_of(out.sides[0].stiffness, out.sides[1].stiffness, width);
  out.mass = rate_of(out.sides[0].mass, out.sides[1].mass, width);
  return out;
}

}  // namespace rigfit::model
