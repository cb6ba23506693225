#include "model/linear/modal_analysis.h"

#include <algorithm>
#include <cmath>

#include "model/linear/mode_description.h"
#include "model/linear/modes.h"
#include "model/linear/segment_choice.h"
#include "model/linear/segment_extrapolation.h"
#include "model/scene/model_reduction.h"

namespace rigfit::model {

namespace {

bool all_auto(const Scene& scene, const ModesOptions& options) {
  return std::all_of(scene.members.begin(), scene.members.end(), [&](const Member& member) {
    return options.segments.value_or(member.segments) <= 0;
  });
}

/// Extrapolated modes, where every member leaves its segments to the program. Not known otherwise,
/// nor where the powers of the segments' length do not hold from the start (a column that has
/// buckled when cut coarsely, layers of bending too short for short chains), nor where they do not
/// reach the accuracy asked for.
ExtrapolatedModes extrapolated_modes(const Scene& scene, const ModesOptions& options) {
  constexpr int kCoarse = 12;
  if (!all_auto(scene, options)) return {};
  const ChainModes coarse =
      find_modes(scene, options, std::vector<int>(scene.members.size(), kCoarse));
  if (coarse.order.empty()) return {};
  const SequenceStart start = sequence_start(scene, coarse, scene.accuracy);
  if (!start.resolved) return {};
  ExtrapolatedModes limit = extrapolate_modes(scene, options, start, scene.accuracy);
  if (!(limit.relative_error <= scene.accuracy)) return {};
  return limit;
}

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
  ExtrapolatedModes limit = extrapolated_modes(scene, options);
  SegmentChoice choice;
  out.extrapolated = limit.known;
  if (limit.known) {
    choice = {std::move(limit.segments), std::move(limit.modes), {}};
    choice.error.relative = limit.relative_error;
  } else {
    choice = choose_segments(scene, options);
  }
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
  for (std::size_t i = 0; i < limit.frequency_hz.size(); ++i) {
    out.modes[i].frequency_hz = limit.frequency_hz[i];
    out.modes[i].extrapolated_hz = limit.limit_hz[i];
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
      const std::vector<int> few(scene.members.size(), kSegmentsForCost);
      error = torsion_cost(scene, options, out.extrapolated ? few : choice.segments);
    }
    out.left_out.push_back({"torsion", error});
  }
  return out;
}

}  // namespace rigfit::model
