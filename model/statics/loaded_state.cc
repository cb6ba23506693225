#include "model/statics/loaded_state.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rigfit::model {

namespace {
constexpr double kLongestWay = 0.25;  // way of a load step, of the rig's extent
}

LoadedState loaded_state(const Assembly& assembly, const ChainState& equilibrium,
                         const Eigen::VectorXd& load) {
  const int n = assembly.size();
  const auto segments = static_cast<Eigen::Index>(assembly.chain().segments.size());
  LoadedState out;
  out.state = equilibrium;
  if (load.isZero(0)) {
    out.converged = true;
    return out;
  }
  Eigen::VectorXd force(n), axial(segments), trial_axial(segments);
  EnvelopeMatrix tangent = assembly.matrix();
  EnvelopeFactor factor;
  double extent = 0, stiffest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    extent = std::max(extent, equilibrium.position.row(axis).maxCoeff() -
                                  equilibrium.position.row(axis).minCoeff());
  }
  for (const Segment& segment : assembly.chain().segments) {
    stiffest = std::max(stiffest, segment.EA / segment.length);
  }
  // Places are rounded to an epsilon of the rig's extent; the stiffest spring turns that to force.
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * extent * stiffest;
  double done = 0, step = 1;
  ChainState trial = out.state;
  while (done < 1 && step > 1e-4) {
    const double fraction = std::min(1.0, done + step);
    trial = out.state;
    assembly.axial_forces(trial, axial);
    bool good = false;
    double last_move = 0;
    for (int iteration = 0; iteration < 30; ++iteration) {
      assembly.force_and_tangent(trial, force, tangent, &axial);
      force -= fraction * load;
      assembly.axial_forces(trial, trial_axial);
      const double scale = std::max(load.cwiseAbs().maxCoeff(), trial_axial.cwiseAbs().maxCoeff());
      out.residual = force.cwiseAbs().maxCoeff() / scale;
      ++out.iterations;
      if (!std::isfinite(out.residual)) break;
      if (out.residual < std::max(1e-11, rounding / scale) && iteration > 0 &&
          last_move < 1e-6 * extent) {
        good = true;
        break;
      }
      factor.factor(tangent);
      factor.solve_in_place(force);
      last_move = force.cwiseAbs().maxCoeff();
      // Never farther at once than a tenth of the rig.
      const double scale_down = std::min(1.0, 0.1 * extent / std::max(last_move, 1e-300));
      // Axial forces to first order at the new place, for its geometric stiffness.
      const ChainState before = trial;
      assembly.advance(before, force, -scale_down, trial);
      for (Eigen::Index s = 0; s < segments; ++s) {
        const Segment& segment = assembly.chain().segments[static_cast<std::size_t>(s)];
        const Eigen::Vector3d edge =
            before.position.col(segment.b) - before.position.col(segment.a);
        const Eigen::Vector3d change =
            trial.position.col(segment.b) - trial.position.col(segment.a) - edge;
        axial(s) = trial_axial(s) + segment.EA / segment.length * edge.normalized().dot(change);
      }
    }
    // On the path that leads there from rest, not on another that a long step has found.
    const double moved = (trial.position - out.state.position).cwiseAbs().maxCoeff();
    if (good && moved > kLongestWay * extent && step > 1e-3) good = false;
    if (good) {
      assembly.force_and_tangent(trial, force, tangent);
      good = factor.factor(tangent) && factor.negative_pivots() == 0;
    }
    if (good) {
      out.state = trial;
      done = fraction;
      step = std::min(2 * step, 1 - done);
    } else {
      step = std::min(step, 1 - done) / 2;
    }
  }
  out.converged = done >= 1;
  return out;
}

}  // namespace rigfit::model
