#include "model/frf_synthesis.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>

#include "model/damped_modes.h"
#include "model/modes.h"

namespace rigfit::model {
namespace {

using Complex = std::complex<double>;

/// From displacement (or force) to the sensor's quantity.
Complex derivative(Sensor::Quantity quantity, double omega) {
  switch (quantity) {
    case Sensor::Quantity::acceleration:
      return -omega * omega;
    case Sensor::Quantity::velocity:
      return Complex(0, omega);
    case Sensor::Quantity::displacement:
    case Sensor::Quantity::force:
      break;
  }
  return 1;
}

}  // namespace

SynthesizedFrfs synthesize_frfs(const Scene& scene, const Eigen::VectorXd& frequency_hz,
                                const ModesOptions& options) {
  SynthesizedFrfs out;
  out.frequency_hz = frequency_hz;
  ModesOptions wanted = options;
  const bool ratios = std::any_of(scene.members.begin(), scene.members.end(),
                                  [](const Member& m) { return m.damping_ratio.value_or(0) > 0; });
  const double highest = frequency_hz.size() > 0 ? frequency_hz.maxCoeff() : 0;
  wanted.band_hz = {0.0, 2 * highest};
  std::vector<int> segments;
  for (const Member& member : scene.members) {
    segments.push_back(options.segments ? *options.segments : member.segments);
  }
  const ChainModes modes = ratios && highest > 0 ? find_modes(scene, wanted, segments)
                                                 : prepare_motions(scene, wanted, segments);
  out.equilibrium = describe(*modes.chain, modes.equilibrium, scene);
  if (modes.equilibrium.status != EquilibriumStatus::converged) return out;
  const ChainState& state = modes.equilibrium.state;
  const auto sensors = static_cast<Eigen::Index>(scene.sensors.size());
  const auto loads = static_cast<Eigen::Index>(scene.loads.size());
  out.H.assign(static_cast<std::size_t>(frequency_hz.size()),
               Eigen::MatrixXcd::Zero(sensors, loads));

  for (const MotionModes& motion : modes.motions) {
    const int n = motion.assembly->size();
    EnvelopeMatrix c = motion.assembly->matrix();
    motion.assembly->damping(state, c);
    Eigen::MatrixXcd rows(sensors, n);
    for (Eigen::Index s = 0; s < sensors; ++s) {
      rows.row(s) = sensor_row(*motion.assembly, state, scene, int(s)).transpose().cast<Complex>();
    }
    // Modal dampers' directions M phi behind the loads.
    const Eigen::VectorXd zeta =
        motion.omega2.size() > 0 ? modal_ratios(motion, state, scene) : Eigen::VectorXd();
    const Eigen::Index dampers = zeta.size();
    Eigen::MatrixXcd right(n, loads + dampers);
    for (Eigen::Index l = 0; l < loads; ++l) {
      right.col(l) = load_row(*motion.assembly, int(l)).cast<Complex>();
    }
    for (Eigen::Index r = 0; r < dampers; ++r) {
      right.col(loads + r) = (motion.mass * Eigen::VectorXd(motion.shapes.col(r))).cast<Complex>();
    }
    ComplexEnvelopeMatrix dynamic(motion.stiffness.envelope());
    ComplexEnvelopeFactor factor;
    Eigen::MatrixXcd solution(n, loads + dampers);
    for (Eigen::Index line = 0; line < frequency_hz.size(); ++line) {
      const double omega = 2 * M_PI * frequency_hz[line];
      for (Eigen::Index e = 0; e < dynamic.values().size(); ++e) {
        dynamic.values()[e] =
            Complex(motion.stiffness.values()[e] - omega * omega * motion.mass.values()[e],
                    omega * c.values()[e]);
      }
      factor.factor(dynamic);
      solution = right;
      factor.solve_in_place(solution);
      Eigen::MatrixXcd response = solution.leftCols(loads);
      if (dampers > 0 && omega > 0) {
        // (D + B G B')^-1 = D^-1 - D^-1 B (I + G B' D^-1 B)^-1 G B' D^-1.
        const auto b = right.rightCols(dampers);
        const auto db = solution.rightCols(dampers);
        Eigen::VectorXcd g(dampers);
        for (Eigen::Index r = 0; r < dampers; ++r) {
          g[r] = Complex(0, 2 * zeta[r] * std::sqrt(motion.omega2[r]) * omega);
        }
        Eigen::MatrixXcd small = g.asDiagonal() * (b.transpose() * db);
        small.diagonal().array() += Complex(1);
        const Eigen::MatrixXcd part = g.asDiagonal() * (b.transpose() * response);
        response -= db * small.partialPivLu().solve(part);
      }
      Eigen::MatrixXcd& h = out.H[static_cast<std::size_t>(line)];
      for (Eigen::Index s = 0; s < sensors; ++s) {
        h.row(s) +=
            derivative(scene.sensors[std::size_t(s)].quantity, omega) * (rows.row(s) * response);
      }
    }
  }
  return out;
}

}  // namespace rigfit::model
