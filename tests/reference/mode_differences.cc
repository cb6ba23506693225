#include "tests/reference/mode_differences.h"

#include <cmath>
#include <limits>
#include <map>

namespace rigfit::ident {
namespace {

const model::NaturalMode* counterpart(const std::vector<model::NaturalMode>& modes,
                                      model::ModePlane plane, int order) {
  for (const auto& mode : modes) {
    if (mode.plane == plane && order-- == 0) return &mode;
  }
  return nullptr;
}

double step_of(const model::Scene& scene, double value) {
  if (value != 0) return 1e-4 * std::abs(value);
  double reach = 0;
  for (const auto& node : scene.nodes) reach = std::max(reach, node.position.norm());
  return 1e-4 * std::max(reach, 1.0);
}

}  // namespace

model::ModeSensitivities mode_differences(const model::Scene& scene,
                                          const std::vector<std::string>& parameters,
                                          const model::ModesOptions& options) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  model::ModeSensitivities result;
  result.analysis = model::analyse_modes(scene, options);
  const auto& modes = result.analysis.modes;
  const auto rows = static_cast<Eigen::Index>(modes.size());
  const auto columns = static_cast<Eigen::Index>(parameters.size());
  result.frequency = result.damping_ratio = Eigen::MatrixXd::Constant(rows, columns, kNaN);
  if (parameters.empty()) return result;
  // The number of segments must not change from one analysis to the next.
  model::Scene fixed = scene;
  for (std::size_t m = 0; m < fixed.members.size(); ++m) {
    if (m < result.analysis.equilibrium.members.size()) {
      fixed.members[m].segments = result.analysis.equilibrium.members[m].segments;
    }
  }
  for (Eigen::Index p = 0; p < columns; ++p) {
    const auto& name = parameters[static_cast<std::size_t>(p)];
    const double value = model::parameter(scene, name);
    const double step = step_of(scene, value);
    model::Scene up = fixed, down = fixed;
    const bool one_sided = value == 0;  // a mass of zero cannot be less
    model::set_parameter(up, name, value + step);
    if (!one_sided) model::set_parameter(down, name, value - step);
    const auto above = model::analyse_modes(up, options).modes;
    const auto below = model::analyse_modes(down, options).modes;
    const double width = one_sided ? step : 2 * step;
    std::map<model::ModePlane, int> seen;
    for (Eigen::Index k = 0; k < rows; ++k) {
      const auto plane = modes[static_cast<std::size_t>(k)].plane;
      const int order = seen[plane]++;
      const auto* high = counterpart(above, plane, order);
      const auto* low = counterpart(below, plane, order);
      if (high == nullptr || low == nullptr) continue;
      result.frequency(k, p) = (high->frequency_hz - low->frequency_hz) / width;
      result.damping_ratio(k, p) = (high->damping_ratio - low->damping_ratio) / width;
    }
  }
  return result;
}

}  // namespace rigfit::ident
