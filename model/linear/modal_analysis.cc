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

}  // namespace

ModalAnalysis analyse_modes(const Scene& scene, const ModesOptions& options) {
  ModalAnalysis out;
  const ResolvedModes resolved = resolve_modes(scene, options);
  const ChainModes& modes = resolved.modes;
  out.extrapolated = resolved.extrapolated;
  out.equilibrium = describe(*modes.chain, modes.equilibrium, scene);
  for (const MotionModes& motion : modes.motions) out.unknowns += motion.assembly->size();
  if (modes.equilibrium.status != EquilibriumStatus::converged) return out;
  out.modes = natural_modes(modes, scene, options);
  resolved.put_frequencies(out.modes);
  out.complete = modes.complete();
  out.relative_error_estimate = resolved.relative_error;

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
