// d omega^2 / dp = phi' (dK/dp - omega^2 dM/dp) phi with the change of the equilibrium with p in
// dK/dp (perturbed_equilibrium.h): no eigenvalue problem and no equilibrium is solved again. Shapes
// follow by Nelson's method (R. B. Nelson, AIAA Journal 14, 1976).

#include "model/algebra/numbers.h"
#include "model/linear/damped_modes.h"
#include "model/linear/modal_analysis.h"
#include "model/linear/perturbed_equilibrium.h"
#include "model/linear/segment_extrapolation.h"

namespace rigfit::model {
namespace {

/// Rates of one motion's modes, by the matrices' rates.
struct ModeRates {
  VectorXd omega2;
  MatrixXd shapes;
};

/// The rates of a motion's modes by any parameter: what does not depend on it is found once.
class ModeRateFinder {
 public:
  explicit ModeRateFinder(const MotionModes& motion)
      : motion_(motion),
        mass_shapes_(motion.mass * motion.shapes),
        factors_(static_cast<std::size_t>(motion.omega2.size())) {}

  ModeRates find(const EnvelopeMatrix& dk, const EnvelopeMatrix& dm, bool shapes) {
    ModeRates rates;
    const Index count = motion_.omega2.size();
    rates.omega2.setZero(count);
    rates.shapes.setZero(motion_.shapes.rows(), count);
    if (dk.values().isZero(0) && dm.values().isZero(0)) return rates;  // such as a damping ratio
    for (Index i = 0; i < count; ++i) {
      const VectorXd phi = motion_.shapes.col(i);
      const VectorXd dk_phi = dk * phi, dm_phi = dm * phi;
      rates.omega2[i] = phi.dot(dk_phi) - motion_.omega2[i] * phi.dot(dm_phi);
      if (!shapes) continue;
      const auto m_phi = mass_shapes_.col(i);
      VectorXd v = -(dk_phi - motion_.omega2[i] * dm_phi) + rates.omega2[i] * m_phi;
      factor(i).solve_in_place(v);
      rates.shapes.col(i) = v - (m_phi.dot(v) + 0.5 * phi.dot(dm_phi)) * phi;
    }
    return rates;
  }

 private:
  /// (K - omega^2 M) v = right, with v = 0 where phi is largest: any stiffness added there makes
  /// the matrix regular and, the right side being normal to phi, changes nothing.
  const EnvelopeFactor& factor(Index i) {
    auto& found = factors_[static_cast<std::size_t>(i)];
    if (found) return *found;
    EnvelopeMatrix shifted = motion_.stiffness;
    shifted.values() -= motion_.omega2[i] * motion_.mass.values();
    Index largest = 0;
    mass_shapes_.col(i).cwiseAbs().maxCoeff(&largest);
    shifted.add(int(largest), int(largest), motion_.stiffness.at(int(largest), int(largest)));
    found.emplace().factor(shifted);
    return *found;
  }

  const MotionModes& motion_;
  MatrixXd mass_shapes_;
  std::vector<std::optional<EnvelopeFactor>> factors_;
};

/// Central differences with all modes found anew, for parameters whose matrices on both sides do
/// not compare: a node leaves the plane of symmetry, to either side alike, so that frequencies and
/// damping are even in p.
void difference_anew(const Scene& scene, const ParameterAccess& access, const ParameterStep& step,
                     const ChainModes& modes, const ModesOptions& options, Index p,
                     ModeSensitivities& out) {
  const std::vector<int> segments = modes.chain->segment_counts();
  const auto at = [&](double value) {
    Scene moved = scene;
    access.set(moved, value);
    return find_modes(moved, options, segments);
  };
  const ChainModes below = at(step.low), above = at(step.high);
  for (Index i = 0; i < out.frequency.rows(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (below.order.size() > k && above.order.size() > k) {
      out.frequency(i, p) = (above.frequency_hz(k) - below.frequency_hz(k)) / step.width();
    }
  }
}

}  // namespace

ModeSensitivities mode_sensitivities_by(const Scene& scene,
                                        const std::vector<ParameterAccess>& wanted,
                                        const ModesOptions& options) {
  ModeSensitivities out;
  const ResolvedModes resolved = resolve_modes(scene, options);
  const ChainModes& modes = resolved.modes;
  out.analysis = analysis_of(resolved, scene, options);
  const auto count = static_cast<Index>(modes.order.size());
  const auto columns = static_cast<Index>(wanted.size());
  out.frequency.setZero(count, columns);
  out.damping_ratio.setZero(count, columns);
  if (modes.equilibrium.status != EquilibriumStatus::converged) return out;

  const BorderedSolver tangent = tangent_at_rest(*modes.chain, modes.equilibrium.state);
  std::vector<ModeRateFinder> finders(modes.motions.begin(), modes.motions.end());
  for (Index p = 0; p < columns; ++p) {
    const ParameterAccess& access = wanted[std::size_t(p)];
    const Neighbours near = neighbours_of(scene, modes, tangent, access);
    const ParameterStep& step = near.step;
    if (!near.comparable) {
      difference_anew(scene, access, near.step.wider(), modes, options, p, out);
      continue;
    }
    for (std::size_t m = 0; m < modes.motions.size(); ++m) {
      const MotionModes& motion = modes.motions[m];
      if (motion.omega2.size() == 0) continue;
      MotionRates moved = motion_rates(near, motion);
      auto& [below, above] = moved.sides;
      const ModeRates rates = finders[m].find(moved.stiffness, moved.mass, options.damped);

      VectorXd damping_rate = VectorXd::Zero(motion.omega2.size());
      if (options.damped) {  // the shapes move too
        below.omega2 = motion.omega2 + (step.low - step.value) * rates.omega2;
        above.omega2 = motion.omega2 + (step.high - step.value) * rates.omega2;
        below.shapes = motion.shapes + (step.low - step.value) * rates.shapes;
        above.shapes = motion.shapes + (step.high - step.value) * rates.shapes;
        const VectorXcd p0 = damped_poles(below, near.rigs[0].state, near.rigs[0].scene);
        const VectorXcd p1 = damped_poles(above, near.rigs[1].state, near.rigs[1].scene);
        for (Index i = 0; i < damping_rate.size(); ++i) {
          damping_rate[i] = (damping_ratio_of(p1[i]) - damping_ratio_of(p0[i])) / step.width();
        }
      }
      for (Index i = 0; i < count; ++i) {
        const auto& which = modes.order[std::size_t(i)];
        if (which.motion != int(m)) continue;
        const double omega = std::sqrt(motion.omega2[which.mode]);
        // Relative rates differ less from chain to chain than rates.
        out.frequency(i, p) =
            resolved.frequency_hz[std::size_t(i)] * rates.omega2[which.mode] / (2 * omega * omega);
        out.damping_ratio(i, p) = damping_rate[which.mode];
      }
    }
  }
  return out;
}

}  // namespace rigfit::model
