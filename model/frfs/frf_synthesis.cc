#include "model/frfs/frf_synthesis.h"

#include <algorithm>
#include <cmath>

#include "model/frfs/frf_equations.h"
#include "model/linear/segment_choice.h"

namespace rigfit::model {

ChainModes frf_modes(const Scene& scene, const Eigen::VectorXd& frequency_hz,
                     const ModesOptions& options) {
  ModesOptions wanted = options;
  const bool ratios = std::any_of(scene.members.begin(), scene.members.end(),
                                  [](const Member& m) { return m.damping_ratio.value_or(0) > 0; });
  const double highest = frequency_hz.size() > 0 ? frequency_hz.maxCoeff() : 0;
  wanted.band_hz = {0.0, 2 * highest};
  std::vector<int> segments;
  bool choose = false;
  for (const Member& member : scene.members) {
    segments.push_back(options.segments ? *options.segments : member.segments);
    choose = choose || segments.back() <= 0;
  }
  if (choose && highest > 0) {
    ModesOptions asked = options;
    asked.band_hz = {0.0, highest};
    const SegmentChoice choice = choose_segments(scene, asked);
    // Without a mode among the lines there is nothing to choose by: the default.
    if (!choice.modes.order.empty()) segments = choice.segments;
  }
  return ratios && highest > 0 ? find_modes(scene, wanted, segments)
                               : prepare_motions(scene, wanted, segments);
}

SynthesizedFrfs synthesize_frfs(const Scene& scene, const Eigen::VectorXd& frequency_hz,
                                const ModesOptions& options, double decay_rate_1_s) {
  SynthesizedFrfs out;
  out.frequency_hz = frequency_hz;
  const ChainModes modes = frf_modes(scene, frequency_hz, options);
  out.equilibrium = describe(*modes.chain, modes.equilibrium, scene);
  if (modes.equilibrium.status != EquilibriumStatus::converged) return out;
  const auto sensors = static_cast<Eigen::Index>(scene.sensors.size());
  const auto loads = static_cast<Eigen::Index>(scene.loads.size());
  out.H.assign(static_cast<std::size_t>(frequency_hz.size()),
               Eigen::MatrixXcd::Zero(sensors, loads));
  for (const MotionModes& motion : modes.motions) {
    const FrfEquations equations = frf_equations(motion, modes.equilibrium.state, scene);
    const Eigen::MatrixXcd rows = equations.sensors.transpose().cast<std::complex<double>>();
    FrfSolver solver(equations, equations.loads);
    for (Eigen::Index line = 0; line < frequency_hz.size(); ++line) {
      const std::complex<double> laplace = laplace_variable(frequency_hz[line], decay_rate_1_s);
      const Eigen::MatrixXcd h = rows * solver.solve(laplace);
      for (Eigen::Index s = 0; s < sensors; ++s) {
        out.H[std::size_t(line)].row(s) +=
            quantity_factor(scene.sensors[std::size_t(s)].quantity, laplace) * h.row(s);
      }
    }
  }
  return out;
}

}  // namespace rigfit::model
