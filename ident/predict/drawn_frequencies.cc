#include "ident/predict/drawn_frequencies.h"

#include <algorithm>
#include <cstddef>

namespace rigfit::ident {
namespace {

using model::ModePlane;

/// Place of each mode among those before it of the same plane.
std::vector<std::size_t> orders_of(const std::vector<model::NaturalMode>& reference) {
  std::vector<std::size_t> orders;
  orders.reserve(reference.size());
  for (auto mode = reference.begin(); mode != reference.end(); ++mode) {
    orders.push_back(static_cast<std::size_t>(std::count_if(
        reference.begin(), mode, [&](const auto& one) { return one.plane == mode->plane; })));
  }
  return orders;
}

/// `planes` of `hz`, both by rising frequency; empty: a mode is missing.
Eigen::VectorXd like(const std::vector<model::NaturalMode>& reference,
                     const std::vector<std::size_t>& orders, const std::vector<ModePlane>& planes,
                     const std::vector<double>& hz) {
  Eigen::VectorXd found(static_cast<Eigen::Index>(reference.size()));
  for (std::size_t i = 0; i < reference.size(); ++i) {
    std::size_t seen = 0, k = 0;
    for (; k < planes.size(); ++k) {
      if (planes[k] == reference[i].plane && seen++ == orders[i]) break;
    }
    if (k == planes.size()) return {};
    found[static_cast<Eigen::Index>(i)] = hz[k];
  }
  return found;
}

Eigen::VectorXd frequencies_alone(const model::Scene& scene,
                                  const std::vector<model::NaturalMode>& reference,
                                  const std::vector<std::size_t>& orders,
                                  const model::ModesOptions& options) {
  const auto analysis = model::analyse_modes(scene, options);
  std::vector<ModePlane> planes;
  std::vector<double> hz;
  planes.reserve(analysis.modes.size());
  hz.reserve(analysis.modes.size());
  for (const auto& mode : analysis.modes) {
    planes.push_back(mode.plane);
    hz.push_back(mode.frequency_hz);
  }
  return like(reference, orders, planes, hz);
}

}  // namespace

bool all_auto(const model::Scene& scene, const model::ModesOptions& options) {
  return std::all_of(scene.members.begin(), scene.members.end(), [&](const auto& member) {
    return options.segments.value_or(member.segments) <= 0;
  });
}

std::vector<Eigen::VectorXd> drawn_frequencies(std::span<const model::Scene> scenes,
                                               const std::vector<model::NaturalMode>& reference,
                                               const model::ModesOptions& options,
                                               double accuracy) {
  const std::vector<std::size_t> orders = orders_of(reference);
  std::vector<Eigen::VectorXd> out(scenes.size());
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    model::ModesOptions own = options;
    if (all_auto(scenes[s], options)) own.accuracy = accuracy;
    out[s] = frequencies_alone(scenes[s], reference, orders, own);
  }
  return out;
}

}  // namespace rigfit::ident
