#include "model/linear/modal_analysis.h"

#include <algorithm>
#include <cmath>

#include "model/linear/mode_description.h"
#include "model/linear/modes.h"
#include "model/linear/segment_extrapolation.h"
#include "model/scene/model_reduction.h"

namespace rigfit::model {

namespace {

/// What leaving torsion out changes: the largest relative change of a frequency.
double torsion_cost(const Scene& scene, const ModesOptions& options,
                    const std::vector<int>& segments) {
  ModesOptions with = options;
  with.torsion.reset();
  const ChainModes full = find_modes(scene, with, segments);
  const ChainModes without = find_modes(scene, options, segments);
  double cost = 0;
  for (std::size_t i = 0; i < std::min(full.order.size(), without.order.size()); ++i) {
    cost = std::max(cost, std::abs(full.frequency_hz(i) / without.frequency_hz(i) - 1));
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

ModalAnalysis analyse_modes(const Scene& scene, const ModesOptions& options) {
  ModalAnalysis out;
  const ResolvedModes resolved = resolve_modes(scene, options);
  const ChainModes& modes = resolved.modes;
  out.extrapolated = resolved.extrapolated;
  out.relative_error_estimate = resolved.relative_error;
  out.equilibrium = describe(*modes.chain, modes.equilibrium, scene);
  for (const MotionModes& motion : modes.motions) out.unknowns += motion.assembly->size();
  if (modes.equilibrium.status != EquilibriumStatus::converged) return out;
  out.modes = natural_modes(resolved, scene, options);
  out.complete = modes.complete();
  const double section = section_cost(scene, out.modes);
  if (section > 0) out.left_out.push_back({"section inertia and shear of beams", section});

  const Chain& chain = *modes.chain;
  if (chain.planar) {
    out.kept = {"in-plane motion",
                "out-of-plane motion, separately: the scene has a plane of symmetry"};
  } else {
    out.kept = {"motion in space"};
  }
  out.kept.push_back("axial stretch, dynamically");
  if (chain.torsion) {
    out.kept.push_back("torsion");
  } else {
    const ModelReduction reduction = reduce_model(scene, options.torsion);
    double error = 0;
    if (reduction.torsion_left_out) {
      const std::vector<int> few(scene.members.size(), kSegmentsForCost);
      error = torsion_cost(scene, options, out.extrapolated ? few : resolved.segments);
    }
    out.left_out.push_back({"torsion", error});
  }
  return out;
}

}  // namespace rigfit::model
