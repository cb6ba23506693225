#include "model/statics/equilibrium.h"

namespace rigfit::model {
namespace {

constexpr int kMostIterations = 40;  // Newton iterations of each continuation step
constexpr double kResidual = 1e-9;   // largest unbalanced force over the largest member force
constexpr double kSmallStep = 1e-9;  // largest last displacement over the rig's extent
constexpr int kMostContinuationSteps = 60;
constexpr double kLongestWay = 0.25;  // way of a load step, of the rig's extent

/// What of the rig acts at a stage of the continuation, 1: all of it.
void scale_bending(Chain& chain, const Chain& whole, double part) {
  for (std::size_t m = 0; m < chain.members.size(); ++m) {
    const ChainMember& member = chain.members[m];
    if (!member.cable) continue;
    // Lengths may have changed since `whole`: springs go with 1 / L.
    const double factor = part * whole.members[m].unstretched_length / member.unstretched_length;
    const auto set = [factor](JointSprings& out, const JointSprings& in) {
      out.about_1 = in.about_1 * factor;
      out.about_2 = in.about_2 * factor;
    };
    for (int i = 0; i + 1 < member.segments; ++i) {
      const auto k = at(member.first_joint + i);
      set(chain.inner_joints[k].springs, whole.inner_joints[k].springs);
    }
    for (const int e : member.end_joint) {
      if (e < 0) continue;
      const auto k = at(e);
      set(chain.end_joints[k].springs, whole.end_joints[k].springs);
    }
  }
}

Motion motion_at_rest(const Chain& chain) {
  return chain.planar ? Motion::in_plane : Motion::space;
}

class Solver {
 public:
  /// The lengths of cables with a tension are sought unless the chain is settled.
  Solver(Chain& chain, Motion motion)
      : chain_(chain),
        assembly_(chain, motion),
        tangent_(assembly_.matrix()),
        force_(assembly_.size()) {
    for (std::size_t m = 0; m < chain.members.size(); ++m) {
      if (chain.members[m].target_tension && !chain.settled)
        targets_.push_back(static_cast<int>(m));
    }
    const auto n = assembly_.size();
    const auto k = static_cast<Index>(targets_.size());
    mismatch_.resize(k);
    diagonal_.resize(k);
    gradient_.resize(n, k);
    border_.resize(n, k);
    extent_ = (chain.drawn.rowwise().maxCoeff() - chain.drawn.rowwise().minCoeff()).norm();
    support_rounding_.setZero(n);
    const double rounding = 16 * std::numeric_limits<double>::epsilon();
    const Numbering& numbering = assembly_.numbering();
    for (const NodeSupport& support : chain.supports) {
      const double coordinate = chain.drawn.col(support.node).cwiseAbs().maxCoeff() + extent_;
      for (int axis = 0; axis < 3; ++axis) {
        const int i = numbering.displacement(axis, support.node);
        const double stiffness = support.translational[axis];
        if (i >= 0) support_rounding_[i] += rounding * stiffness * coordinate;
        const int r = support.rotation < 0 ? -1 : numbering.rotation(axis, support.rotation);
        if (r >= 0) support_rounding_[r] += rounding * support.rotational.maxCoeff();
      }
    }
  }

  /// The tangent at `state`, factored.
  BorderedSolver tangent_at(const ChainState& state) {
    assembly_.force_and_tangent(state, force_, tangent_);
    stiffen_idle_rotations();
    for (Index i = 0; i < diagonal_.size(); ++i) {
      assembly_.tension_gradient(state, targets_[std::size_t(i)], gradient_.col(i), diagonal_[i]);
    }
    factor_tangent(state);
    return std::move(bordered_);
  }

  /// Newton from `state`. `hold`: stiffness with which scene nodes are held where drawn, N/m;
  /// `load`: forces on the unknowns, or none; `near`: the tangent to use throughout, that of a
  /// state and a chain near by.
  bool solve(ChainState& state, double hold, const VectorXd& load = {},
             const BorderedSolver* near = nullptr) {
    const auto k = static_cast<Index>(targets_.size());
    axial_ = axial_forces(chain_, state);
    double last_step = std::numeric_limits<double>::infinity(), step_before = last_step;
    for (int iteration = 0; iteration <= kMostIterations; ++iteration) {
      if (near) {
        assembly_.force(state, force_);
      } else {
        assembly_.force_and_tangent(state, force_, tangent_, &axial_);
        if (!chain_.settled) stiffen_idle_rotations();
      }
      if (hold > 0) add_hold(state, hold);
      if (load.size() > 0) force_ -= load;
      measure(state);
      for (Index i = 0; i < k; ++i) {
        const int target = targets_[std::size_t(i)];
        const double value =
            assembly_.tension_gradient(state, target, gradient_.col(i), diagonal_[i]);
        mismatch_[i] = *chain_.members[at(target)].target_tension - value;
        unbalanced_ = std::max(unbalanced_, std::abs(mismatch_[i]));
      }
      residual = scale_ > 0 ? unbalanced_ / scale_ : unbalanced_;
      if (!std::isfinite(residual)) return false;
      if (near) {  // each step is a small part of the one before, down to rounding
        if (last_step <= 1e-4 * kSmallStep * extent_ || last_step > 0.5 * step_before) {
          return residual <= kResidual || unbalanced_ <= rounding_;
        }
      } else if ((last_step <= kSmallStep * extent_ && residual <= kResidual) ||
                 (last_step <= 1e3 * kSmallStep * extent_ && unbalanced_ <= rounding_)) {
        return true;
      }
      step_before = last_step;
      if (iteration == kMostIterations) return false;
      if (!near) factor_tangent(state);
      column_ = -force_;
      lengths_ = mismatch_;
      (near ? *near : bordered_).solve_in_place(column_, lengths_);
      if (!column_.allFinite() || !lengths_.allFinite()) return false;
      step(state, last_step);
      ++iterations;
    }
    return false;
  }

  double residual = 0;
  int iterations = 0;
  [[nodiscard]] double extent() const { return extent_; }  ///< m
  [[nodiscard]] Index size() const { return assembly_.size(); }

 private:
  void factor_tangent(const ChainState& state) {
    for (Index i = 0; i < border_.cols(); ++i) {
      assembly_.length_derivative(state, targets_[std::size_t(i)], border_.col(i));
    }
    bordered_.factor(tangent_, border_, gradient_, diagonal_);
  }

  /// Node rotations that nothing bears yet get a stiffness in the step, not in the force.
  void stiffen_idle_rotations() {
    double largest = 0;
    for (const InnerJoint& joint : chain_.inner_joints) {
      largest = std::max({largest, joint.springs.about_1, joint.springs.about_2});
    }
    const Eigen::Matrix3Xi& rotation = assembly_.numbering().rotation;
    for (Index i = 0; i < rotation.size(); ++i) {
      if (rotation(i) >= 0) tangent_.add(rotation(i), rotation(i), 1e-10 * largest);
    }
  }

  void add_hold(const ChainState& state, double hold) {
    for (int node = 0; node < chain_.scene_nodes; ++node) {
      for (int axis = 0; axis < 3; ++axis) {
        const int i = assembly_.numbering().displacement(axis, node);
        if (i < 0) continue;
        force_[i] += hold * (state.position(axis, node) - chain_.drawn(axis, node));
        tangent_.add(i, i, hold);
      }
    }
  }

  /// The largest unbalanced force, the largest member force, and what rounding of positions makes.
  /// A support's spring gets its force by a displacement: where that rounds, the force does, and
  /// only what is beyond it is out of balance.
  void measure(const ChainState& state) {
    unbalanced_ =
        force_.size() > 0 ? (force_.cwiseAbs() - support_rounding_).cwiseMax(0).maxCoeff() : 0;
    scale_ = axial_forces(chain_, state).cwiseAbs().maxCoeff();
    double stiffest = 0;
    for (const Segment& s : chain_.segments) {
      scale_ = std::max(scale_, s.mass * chain_.gravity.norm());
      stiffest = std::max(stiffest, s.EA / s.length);
    }
    for (const InnerJoint& joint : chain_.inner_joints) {
      const double l = chain_.segments[at(joint.segment[0])].length;
      const double k = std::max(joint.springs.about_1, joint.springs.about_2) / (l * l);
      stiffest = std::max(stiffest, 4 * k);
    }
    rounding_ = 16 * std::numeric_limits<double>::epsilon() * stiffest *
                (state.position.cwiseAbs().maxCoeff() + extent_);
  }

  /// Applies the step, shortened so that no segment turns by more than half a radian and no length
  /// changes by more than a third.
  void step(ChainState& state, double& size) {
    double factor = 1;
    const Eigen::Matrix3Xi& unknown = assembly_.numbering().displacement;
    const auto shift = [&](int node) {
      return assembly_.numbering().displacement_in(column_, node);
    };
    for (std::size_t k = 0; k < chain_.segments.size(); ++k) {
      const Segment& s = chain_.segments[k];
      const Vector3d e = state.position.col(s.b) - state.position.col(s.a);
      const Vector3d de = shift(s.b) - shift(s.a);
      const double turn = (de - e * e.dot(de) / e.squaredNorm()).norm() / e.norm();
      if (turn * factor > 0.5) factor = 0.5 / turn;
    }
    const Eigen::Matrix3Xi& rotation = assembly_.numbering().rotation;
    for (Index i = 0; i < rotation.size(); ++i) {
      const double turn = rotation(i) >= 0 ? std::abs(column_[rotation(i)]) : 0;
      if (turn * factor > 0.5) factor = 0.5 / turn;
    }
    for (Index i = 0; i < lengths_.size(); ++i) {
      const double part = std::abs(lengths_[i]) /
                          chain_.members[std::size_t(targets_[std::size_t(i)])].unstretched_length;
      if (part * factor > 1.0 / 3) factor = 1.0 / (3 * part);
    }
    axial_ = axial_forces(chain_, state);
    for (std::size_t k = 0; k < chain_.segments.size(); ++k) {
      const Segment& s = chain_.segments[k];
      const Vector3d e = state.position.col(s.b) - state.position.col(s.a);
      axial_[Index(k)] += factor * s.EA / s.length * e.dot(shift(s.b) - shift(s.a)) / e.norm();
    }
    for (Index i = 0; i < lengths_.size(); ++i) {
      const int m = targets_[std::size_t(i)];
      const ChainMember& member = chain_.members[at(m)];
      for (int j = 0; j < member.segments; ++j) {
        const int k = member.first_segment + j;
        const Segment& s = chain_.segments[at(k)];
        const double length = (state.position.col(s.b) - state.position.col(s.a)).norm();
        axial_[k] -= factor * s.EA * length / s.length * lengths_[i] / member.unstretched_length;
      }
    }
    size = 0;
    for (Index i = 0; i < unknown.size(); ++i) {
      if (unknown(i) >= 0) size = std::max(size, std::abs(column_[unknown(i)]));
    }
    assembly_.advance(state, column_, factor, state);
    for (Index i = 0; i < lengths_.size(); ++i) {
      const int m = targets_[std::size_t(i)];
      chain_.set_unstretched_length(
          m, chain_.members[at(m)].unstretched_length + factor * lengths_[i]);
    }
  }

  Chain& chain_;
  Assembly assembly_;
  EnvelopeMatrix tangent_;
  std::vector<int> targets_;
  VectorXd force_, column_, axial_, mismatch_, lengths_, diagonal_;
  VectorXd support_rounding_;   ///< rounding of the supports' spring forces
  MatrixXd gradient_, border_;  // gradients of the targets' tensions, forces by their lengths
  BorderedSolver bordered_;
  double extent_ = 0, unbalanced_ = 0, scale_ = 0, rounding_ = 0;
};

}  // namespace

const char* name_of(EquilibriumStatus status) {
  constexpr const char* kNames[] = {"converged", "slack", "buckled", "mechanism", "not converged"};
  return kNames[static_cast<std::size_t>(status)];
}

ChainEquilibrium find_equilibrium(Chain& chain, const Scene& scene) {
  ChainEquilibrium result;
  chain.settled = false;
  ChainState& state = result.state;
  const Chain drawn = chain;

  // First with the sag that tension and bending give together, then that of tension alone.
  for (const bool with_bending : {true, false}) {
    chain = drawn;
    if (!hang_cables(chain, scene, with_bending, result)) return result;
    Solver solver(chain, motion_at_rest(chain));
    const bool converged = solver.solve(state, 0);
    result.iterations += solver.iterations;
    result.residual = solver.residual;
    if (!converged) continue;
    settle(chain, state);
    judge_rest(chain, scene, result);
    if (result.status == EquilibriumStatus::converged ||
        result.status == EquilibriumStatus::mechanism) {
      return result;
    }
    if (chain.members.size() == 1 && !chain.members[0].cable) return result;  // one branch only
  }

  // From limp cables between held nodes to the whole rig; each step half as long when it fails.
  chain = drawn;
  if (!hang_cables(chain, scene, false, result)) return result;
  const ChainState start = state;
  const Chain whole = chain;
  double hold_start = 0;
  for (const Segment& s : chain.segments) hold_start = std::max(hold_start, s.EA / s.length);
  double force_scale = 1e-9 * hold_start;
  for (const ChainMember& member : chain.members) {
    if (member.target_tension) force_scale = std::max(force_scale, *member.target_tension);
  }
  Solver solver(chain, motion_at_rest(chain));
  double done = 0, step = 0.25;
  for (int k = 0; k < kMostContinuationSteps && done < 1; ++k) {
    const double part = std::min(1.0, done + step);
    const Chain chain_before = chain;
    const ChainState state_before = state;
    scale_bending(chain, whole, part * part * part);
    // The hold falls by decades, then goes.
    const double hold =
        part < 1 ? std::pow(10.0, 6 * (1 - part)) * force_scale / chain.drawn.norm() * (1 - part)
                 : 0;
    if (solver.solve(state, hold)) {
      done = part;
      step *= 1.6;
    } else {
      chain = chain_before;
      state = state_before;
      step *= 0.4;
      if (step < 1e-4) break;
    }
  }
  result.iterations += solver.iterations;
  result.residual = solver.residual;
  if (done < 1) {
    if (result.status == EquilibriumStatus::not_converged) {
      result.reason =
          "no equilibrium was found near the drawn shape; check the nodes' positions, the tensions "
          "and what carries them";
      // A beam that its loads push past its strength is the usual cause: say so when it is one.
      chain = whole;
      state = start;
      settle(chain, state);
      ChainEquilibrium probe;
      probe.state = start;
      judge_rest(chain, scene, probe);
      if (probe.status != EquilibriumStatus::converged) {
        result.status = probe.status;
        result.reason = "no equilibrium was found near the drawn shape: " + probe.reason;
      }
    }
    return result;
  }
  settle(chain, state);
  judge_rest(chain, scene, result);
  return result;
}

BorderedSolver tangent_at_rest(Chain chain, const ChainState& state) {
  chain.settled = false;
  return Solver(chain, motion_at_rest(chain)).tangent_at(state);
}

bool come_to_rest(Chain& chain, ChainState& state, const BorderedSolver& near) {
  chain.settled = false;
  Solver solver(chain, motion_at_rest(chain));
  // A spring from zero on has one rotation more.
  const bool like = solver.size() == near.size();
  if (!solver.solve(state, 0, {}, like ? &near : nullptr)) return false;
  settle(chain, state);
  return true;
}

std::optional<ChainState> loaded_state(const Assembly& assembly, const ChainState& equilibrium,
                                       const VectorXd& load) {
  ChainState state = equilibrium;
  Chain chain = assembly.chain();
  Solver solver(chain, assembly.numbering().motion);
  VectorXd force(assembly.size());
  EnvelopeMatrix tangent = assembly.matrix();
  EnvelopeFactor factor;
  double done = load.isZero(0) ? 1 : 0, step = 1;
  while (done < 1 && step > 1e-4) {
    const double fraction = std::min(1.0, done + step);
    ChainState trial = state;
    bool good = solver.solve(trial, 0, fraction * load);
    // On the path that leads there from rest, not on another that a long step has found.
    const double moved = (trial.position - state.position).cwiseAbs().maxCoeff();
    if (moved > kLongestWay * solver.extent() && step > 1e-3) good = false;
    if (good) {
      assembly.force_and_tangent(trial, force, tangent);
      good = factor.factor(tangent) && factor.negative_pivots() == 0;
    }
    if (good) {
      state = std::move(trial);
      done = fraction;
      step = std::min(2 * step, 1 - done);
    } else {
      step = std::min(step, 1 - done) / 2;
    }
  }
  return done < 1 ? std::nullopt : std::optional(std::move(state));
}

Equilibrium describe(const Chain& chain, const ChainEquilibrium& equilibrium, const Scene& scene) {
  Equilibrium out = equilibrium;
  if (equilibrium.status != EquilibriumStatus::converged) return out;
  const Assembly assembly(chain, motion_at_rest(chain));
  const VectorXd axial = axial_forces(chain, equilibrium.state);
  const Matrix3d back = chain.axes.transpose();
  for (std::size_t m = 0; m < chain.members.size(); ++m) {
    const ChainMember& member = chain.members[m];
    MemberEquilibrium at;
    at.member = scene.members[m].name;
    at.segments = member.segments;
    at.unstretched_length_m = member.unstretched_length;
    at.positions.resize(3, member.segments + 1);
    for (int i = 0; i <= member.segments; ++i) {
      at.positions.col(i) =
          back * equilibrium.state.position.col(member.nodes[static_cast<std::size_t>(i)]);
    }
    const Vector3d from = at.positions.col(0);
    const Vector3d chord = (at.positions.rightCols<1>() - from).normalized();
    for (int i = 0; i < member.segments; ++i) {
      const Vector3d d = at.positions.col(i) - from;
      at.sag_m = std::max(at.sag_m, (d - chord * chord.dot(d)).norm());
    }
    at.tension_max_N = axial.segment(member.first_segment, member.segments).maxCoeff();
    at.tension_N = member.cable ? assembly.tension(equilibrium.state, static_cast<int>(m))
                                : mean_force(chain, member, axial);
    out.members.push_back(std::move(at));
  }
  return out;
}

}  // namespace rigfit::model
