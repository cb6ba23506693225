#include "model/linear/modal_analysis.h"

#include <algorithm>
#include <cmath>

#include "model/linear/mode_description.h"
#include "model/linear/modes.h"
#include "model/linear/segment_choice.h"
#include "model/response/model_reduction.h"

namespace rigfit::model {

ModalAnalysis analyse_modes(const Scene& scene, const ModesOptions& options) {
  ModalAnalysis out;
  const SegmentChoice choice = choose_segments(scene, options);
  const ChainModes& modes = choice.modes;
  out.equilibrium = describe(*modes.chain, modes.equilibrium, scene);
  for (const MotionModes& motion : modes.motions) out.unknowns += motion.assembly->size();
  if (modes.equilibrium.status != EquilibriumStatus::converged) return out;
  out.modes = natural_modes(modes, scene, options);
  out.complete = modes.complete();
  out.relative_error_estimate = choice.error.relative;
  for (std::size_t i = 0; i < choice.error.extrapolated_hz.size() && i < out.modes.size(); ++i) {
    out.modes[i].extrapolated_hz = choice.error.extrapolated_hz[i];
  }

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
      ModesOptions with = options;
      with.torsion.reset();
      const ChainModes full = find_modes(scene, with, choice.segments);
      for (std::size_t i = 0; i < std::min(full.order.size(), modes.order.size()); ++i) {
        error = std::max(error, std::abs(full.frequency_hz(i) / modes.frequency_hz(i) - 1));
      }
    }
    out.left_out.push_back({"torsion", error});
  }
  return out;
}

}  // namespace rigfit::model
