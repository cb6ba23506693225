// Motion that goes far and on for long: a million steps of something stiff with hardly any damping,
// and a beam bent through ninety degrees, where Euler angles end.
#include <fmt/format.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "model/chain/assembly.h"
#include "model/linear/modes.h"
#include "model/motion/explicit_motion.h"
#include "model/motion/stiff_motion.h"
#include "model/response/response.h"
#include "model/statics/equilibrium.h"
#include "model/statics/loaded_state.h"
#include "tests/bench/hard_cases/hard_case.h"
#include "tests/scenes.h"

namespace rigfit::hard_cases {
namespace motion_area {
namespace {

using namespace model;

/// Displacement and velocity of every node of a chain along every axis, as sensors.
void see_all(Chain& chain, MotionProblem& problem) {
  for (int k = 0; k < chain.nodes; ++k) {
    for (const auto quantity : {Sensor::Quantity::displacement, Sensor::Quantity::velocity}) {
      for (int axis = 0; axis < 3; ++axis) {
        ChainPoint point;
        point.node[0] = k;
        point.weight[0] = 1;
        point.count = 1;
        chain.sensors.push_back(point);
        chain.sensor_direction.push_back(Eigen::Vector3d::Unit(axis));
        problem.quantities.push_back(quantity);
      }
    }
  }
}

/// A free beam that spins, bends and flies. EA over EI / l^2 is 1e4 times a segment's share in the
/// paper's beam: every step is one of its axial waves'.
struct FlyingBeam {
  Chain chain;
  MotionProblem problem;
  Eigen::VectorXd mass_of_node;  // lumped, kg: row sums of the mass matrix

  explicit FlyingBeam(bool damped) {
    Scene scene =
        testing::span(testing::member(Member::Kind::beam, "beam", "", "", 4, 0.3, 1e5, 0.6),
                      testing::node("a", {0, 0, 0}), testing::node("b", {1, 0, 0}));
    scene.gravity.setZero();
    if (damped) scene.members[0].damping = {.axial = 1e-2, .bending = 1e-6, .torsion = 0};
    chain = Chain::from_scene(scene);
    chain.settled = true;
    problem.chain = &chain;
    problem.motion = Motion::space;
    see_all(chain, problem);
    problem.rest = problem.start = drawn_state(chain);
    problem.joint_damping = damped;
    const Assembly assembly(chain, Motion::space);
    problem.start_velocity.setZero(assembly.size());
    const Eigen::Vector3d spin(0.5, 3, 10);
    for (int k = 0; k < chain.nodes; ++k) {
      const Eigen::Vector3d x = problem.start.position.col(k);
      const Eigen::Vector3d v =
          spin.cross(x) + Eigen::Vector3d(0.2, 0.3 * std::cos(6 * x[0]), -0.3);
      for (int axis = 0; axis < 3; ++axis) {
        problem.start_velocity(assembly.numbering().displacement(axis, k)) = v[axis];
      }
    }
  }

  /// Linear and angular momentum of a row of samples.
  [[nodiscard]] Eigen::Matrix<double, 6, 1> momenta(const Eigen::MatrixXd& samples,
                                                    Eigen::Index row) const {
    const Assembly assembly(chain, Motion::space);
    EnvelopeMatrix mass = assembly.matrix();
    assembly.mass(mass);
    Eigen::VectorXd v(assembly.size()), p(assembly.size());
    for (int k = 0; k < chain.nodes; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        v(assembly.numbering().displacement(axis, k)) = samples(row, 6 * k + 3 + axis);
      }
    }
    mass.multiply(v, p);
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    for (int k = 0; k < chain.nodes; ++k) {
      Eigen::Vector3d own, x = problem.rest.position.col(k);
      for (int axis = 0; axis < 3; ++axis) {
        own[axis] = p(assembly.numbering().displacement(axis, k));
        x[axis] += samples(row, 6 * k + axis);
      }
      sum.head<3>() += own;
      sum.tail<3>() += x.cross(own);
    }
    return sum;
  }
};

/// omega h of the highest frequency: a tenth of the largest that is stable.
constexpr double kPhase = 0.35;

struct LongFlight {
  MotionOutput out;
  double energy = 0, linear = 0, angular = 0;  ///< largest changes, relative
  double step = 0;
};

LongFlight fly(const FlyingBeam& beam, long steps) {
  LongFlight flight;
  flight.step = kPhase / highest_frequency(beam.chain, Motion::space, beam.problem.start);
  ExplicitOptions run{.step_s = flight.step};
  run.sampling.duration_s = flight.step * static_cast<double>(steps);
  run.sampling.rate_hz = 1000 / run.sampling.duration_s;
  run.sampling.energy_samples = 200;
  flight.out = explicit_motion(beam.problem, run);
  if (!flight.out.completed) return flight;
  flight.energy = flight.out.energy.drift();
  const auto start = beam.momenta(flight.out.samples, 0);
  for (Eigen::Index row = 1; row < flight.out.samples.rows(); ++row) {
    const Eigen::Matrix<double, 6, 1> change = beam.momenta(flight.out.samples, row) - start;
    flight.linear = std::max(flight.linear, change.head<3>().norm() / start.head<3>().norm());
    flight.angular = std::max(flight.angular, change.tail<3>().norm() / start.tail<3>().norm());
  }
  return flight;
}

/// Energy and angular momentum as the scheme's order says, (omega h)^4 / 144, for any number of
/// steps; linear momentum to the rounding of each step.
Outcome a_million_steps(bool quick, bool damped) {
  const long steps = quick ? 100'000 : 1'000'000;
  const FlyingBeam beam(damped);
  const LongFlight flight = fly(beam, steps);
  Worst worst;
  worst.require(flight.out.completed, "not completed: " + flight.out.reason);
  worst.require(flight.out.steps >= steps, "fewer steps");
  const double order = std::pow(kPhase, 4) / 144;
  worst.add(flight.energy, order);
  worst.add(flight.angular, order);
  worst.add(flight.linear, 1.1e-16 * static_cast<double>(steps) * 10);
  if (damped && flight.out.completed) {
    worst.require(flight.out.energy.dissipated > 0, "nothing dissipated");
  }
  return worst.outcome();
}

Outcome undamped(bool quick) { return a_million_steps(quick, false); }
Outcome damped(bool quick) { return a_million_steps(quick, true); }

/// Forward, velocities turned round, back. What is left is the processing of the second start,
/// (omega h)^4 / 144 of the speed of turning, over the time flown.
Outcome reversible(bool quick) {
  FlyingBeam beam(false);
  const LongFlight there = fly(beam, quick ? 5'000 : 50'000);
  Worst worst;
  worst.require(there.out.completed, "not completed: " + there.out.reason);
  if (!there.out.completed) return worst.outcome();
  const Assembly assembly(beam.chain, Motion::space);
  const auto last = there.out.samples.rows() - 1;
  const Eigen::MatrixXd start = there.out.samples.row(0);
  for (int k = 0; k < beam.chain.nodes; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      beam.problem.start.position(axis, k) =
          beam.problem.rest.position(axis, k) + there.out.samples(last, 6 * k + axis);
      beam.problem.start_velocity(assembly.numbering().displacement(axis, k)) =
          -there.out.samples(last, 6 * k + 3 + axis);
    }
  }
  const double duration = there.step * (quick ? 5'000 : 50'000);
  ExplicitOptions run{.step_s = there.step};
  run.sampling = {.duration_s = duration, .rate_hz = 1000 / duration, .energy_samples = 0};
  const MotionOutput back = explicit_motion(beam.problem, run);
  worst.require(back.completed, "not completed: " + back.reason);
  if (!back.completed) return worst.outcome("m");
  double off = 0;
  for (int k = 0; k < beam.chain.nodes; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      off = std::max(off, std::abs(back.samples(last, 6 * k + axis) - start(0, 6 * k + axis)));
    }
  }
  worst.add(off, std::pow(kPhase, 4) / 144 * 10.5 * duration);
  return worst.outcome("m");
}

/// The released cable a hundred times as stiff along, hardly damped: its energy account closes to
/// the accuracy asked for over a million steps.
Outcome stiff_cable(bool quick) {
  Scene scene = testing::released_cable(20);
  scene.members[0].EA *= 100;
  scene.members[0].damping_ratio = 1e-4;
  ResponseOptions options;
  options.sampling = {.duration_s = quick ? 1.0 : 14.0, .rate_hz = 500, .energy_samples = 200};
  options.solver = ResponseSolver::explicit_motion;
  options.axial = true;
  const ResponseResult found = simulate_response(scene, options);
  Worst worst;
  worst.require(found.completed, "not completed: " + found.reason);
  worst.require(quick || found.steps >= 1'000'000, fmt::format("{} steps only", found.steps));
  worst.add(found.energy_drift, scene.accuracy);
  return worst.outcome();
}

constexpr double kLength = 0.75, kEI = 2.1;

/// The elastica: clamped along x, pulled at its tip in the direction `alpha` so that the tip turns
/// by `turn`, EI theta'' = -P sin(alpha - theta). Integrated from the tip, theta = turn - u^2,
/// which takes the root out of ds = dtheta / sqrt(2 P / EI (cos(alpha - turn) - cos(alpha -
/// theta))).
struct Elastica {
  double force_N = 0, x = 0, y = 0;
};

Elastica elastica(double alpha, double turn) {
  const int n = 20000;  // Simpson's rule: good to 1e-15 here
  double length = 0, x = 0, y = 0;
  for (int i = 0; i <= n; ++i) {
    const double u = std::sqrt(turn) * i / n, theta = turn - u * u;
    // cos(a) - cos(b) = 2 sin((a + b) / 2) sin((b - a) / 2), b - a = u^2.
    const double rest = 2 * std::sin(alpha - 0.5 * (turn + theta)) * std::sin(0.5 * u * u);
    const double ds = i == 0 ? 2 / std::sqrt(std::sin(alpha - turn)) : 2 * u / std::sqrt(rest);
    const double weight = (i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2) * std::sqrt(turn) / n / 3;
    length += weight * ds;
    x += weight * ds * std::cos(theta);
    y += weight * ds * std::sin(theta);
  }
  // ds = sqrt(EI / 2 P) times that.
  const double scale = kLength / length;
  return {kEI / (2 * scale * scale), x * scale, y * scale};
}

struct BentBeam {
  Chain chain;
  ChainEquilibrium rest;
  LoadedState loaded;
};

BentBeam bent_beam(int segments, double alpha, double force, double EA = 1e7) {
  Scene scene = testing::vertical_beam(kLength, kEI, 0.295, segments);
  scene.gravity.setZero();
  scene.nodes[1].position << kLength, 0, 0;
  scene.members[0].EA = EA;
  scene.loads = {
      testing::impact({"tip", "", 0}, {std::cos(alpha), std::sin(alpha), 0}, 0, 0, "pull")};
  scene.sensors = {{"tip", {"tip", "", 0}, {1, 0, 0}, Sensor::Quantity::displacement}};
  BentBeam out;
  out.chain = Chain::from_scene(scene);
  out.rest = find_equilibrium(out.chain, scene);
  const Assembly assembly(out.chain, Motion::in_plane);
  out.loaded = loaded_state(assembly, out.rest.state, force * load_row(assembly, 0));
  return out;
}

/// A tip turned by 60, 89.9, 90, 120 and 170 degrees. Whatever order above the first it converges
/// with, the last halving of the segments changes more than is left; axial stretch P / EA.
Outcome through_ninety_degrees(bool) {
  Worst worst;
  for (const double degrees : {60.0, 89.9, 90.0, 120.0, 170.0}) {
    const double turn = degrees * M_PI / 180, alpha = turn + 0.15;
    const Elastica truth = elastica(alpha, turn);
    Eigen::Vector2d tip[2];
    for (int k = 0; k < 2; ++k) {
      const BentBeam bent = bent_beam(k == 0 ? 40 : 80, alpha, truth.force_N);
      worst.require(bent.loaded.converged, fmt::format("{} degrees not found", degrees));
      const Eigen::Vector3d end =
          bent.chain.axes.transpose() *
          bent.loaded.state.position.col(bent.chain.members[0].nodes.back());
      tip[k] = end.head<2>();
    }
    worst.add((tip[1] - Eigen::Vector2d(truth.x, truth.y)).norm() / kLength,
              (tip[1] - tip[0]).norm() / kLength + truth.force_N / 1e7);
  }
  return worst.outcome();
}

/// Let go from a tip turned by 120 degrees it whips through to the other side. The explicit scheme
/// against the stiff one; halving its step changes more than is left of its error.
Outcome whips_back(bool) {
  const double turn = 120 * M_PI / 180, alpha = turn + 0.15;
  const BentBeam bent = bent_beam(8, alpha, elastica(alpha, turn).force_N, 1e5);
  Worst worst;
  worst.require(bent.loaded.converged, "no bent state");
  MotionProblem problem{.chain = &bent.chain,
                        .motion = Motion::in_plane,
                        .rest = bent.rest.state,
                        .start = bent.loaded.state,
                        .quantities = {Sensor::Quantity::displacement}};
  Load none{.kind = Load::Kind::impact, .duration = 1e-3};
  problem.loads = {none};
  problem.records = {nullptr};
  const SamplingOptions sampling{.duration_s = 0.4, .rate_hz = 500, .energy_samples = 100};
  const MotionOutput truth =
      stiff_motion(problem, {.sampling = sampling, .relative_tolerance = 1e-9});
  worst.require(truth.completed, "stiff: " + truth.reason);
  ExplicitOptions run{
      .sampling = sampling,
      .step_s = 0.5 / highest_frequency(bent.chain, Motion::in_plane, bent.loaded.state)};
  const MotionOutput coarse = explicit_motion(problem, run);
  run.step_s = *run.step_s / 2;
  const MotionOutput fine = explicit_motion(problem, run);
  worst.require(coarse.completed && fine.completed, "not completed: " + fine.reason);
  if (!truth.completed || !fine.completed || !coarse.completed) return worst.outcome();
  const double size = truth.samples.norm();
  worst.require(truth.samples.maxCoeff() > -1e-3 && truth.samples.minCoeff() < -kLength,
                "it does not whip");
  worst.add((fine.samples - truth.samples).norm() / size,
            (coarse.samples - fine.samples).norm() / size + 1e-7);
  // Energy to (omega h)^4 / 144 of the step before.
  worst.add(fine.energy.drift(), std::pow(0.5, 4) / 144);
  return worst.outcome();
}

}  // namespace
}  // namespace motion_area

std::vector<HardCase> motion_cases() {
  using namespace motion_area;
  const std::string area = "motion";
  return {
      {area, "stiff free beam, 1e6 steps", "energy, momenta to (omega h)^4 / 144, rounding",
       undamped},
      {area, "the same, lightly damped", "account closes, momenta kept", damped},
      {area, "there and back, 50,000 steps each", "to (omega h)^4 / 144 of the way", reversible},
      {area, "cable of 100 EA, damping 1e-4, 1e6 steps", "account to the accuracy asked",
       stiff_cable},
      {area, "beam's tip turned by 60 to 170 degrees", "elastica, last halving of segments",
       through_ninety_degrees},
      {area, "let go from 120 degrees", "stiff scheme, last halving of the step", whips_back},
  };
}

}  // namespace rigfit::hard_cases
